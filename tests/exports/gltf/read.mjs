// Validates a .glb and poses it with three.js: node read.mjs FILE TIME..., gives JSON.
import { readFileSync } from "node:fs";
import { AnimationMixer, LoopOnce, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import validator from "gltf-validator";

const [path, ...times] = process.argv.slice(2);
const bytes = new Uint8Array(readFileSync(path));
const { issues } = await validator.validateBytes(bytes);
const poses = [];
if (!issues.numErrors) {
  const { scene, animations } = await new GLTFLoader().parseAsync(bytes.buffer, "");
  const skinned = [];
  scene.traverse((one) => one.isSkinnedMesh && skinned.push(one));
  const mixer = new AnimationMixer(scene);
  const action = mixer.clipAction(animations[0]).setLoop(LoopOnce);
  action.clampWhenFinished = true; // the last frame is shown, not the first again
  const list = (vector) => vector.toArray();
  for (const time of times) {
    action.reset().play();
    mixer.setTime(Number(time));
    scene.updateMatrixWorld(true);
    const joints = skinned[0].skeleton.bones.map((bone) => list(bone.getWorldPosition(new Vector3())));
    const vertices = Array.from({ length: skinned[0].geometry.attributes.position.count }, (_, k) =>
      list(skinned[0].getVertexPosition(k, new Vector3()).applyMatrix4(skinned[0].matrixWorld)),
    );
    poses.push({ joints, vertices });
  }
}
console.log(JSON.stringify({ issues, poses }));
