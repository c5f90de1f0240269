// A stick figure: a ball at each joint, a rod for each bone, moved by writing positions into two meshes.
import {
  Color,
  CylinderGeometry,
  Group,
  InstancedMesh,
  Matrix4,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import { GHOST, SIDES, SPARED, shade } from "./colours.js";

const BONE_M = 0.028;
const TRUNK_M = 0.045;
const HEAD_M = 0.1;
const UP = new Vector3(0, 1, 0);

export class Figure extends Group {
  /**
   * @param body parents, sides, headJoint (-1 if there is none) and which joints are spared, if any
   * @param isGhost a second figure: see-through and of one colour
   */
  constructor(body, isGhost = false) {
    super();
    const { parents, sides, headJoint, spared = [] } = body;
    this.parents = parents;
    this.sides = sides;
    this.headJoint = headJoint;
    this.spared = spared;
    this.bones = parents.map((parent, joint) => [parent, joint]).filter(([parent]) => parent >= 0);
    this.isGhost = isGhost;
    this.material = new MeshLambertMaterial({
      transparent: isGhost,
      opacity: isGhost ? 0.45 : 1,
      depthWrite: !isGhost,
    });
    this.balls = new InstancedMesh(new SphereGeometry(1, 20, 14), this.material, parents.length);
    this.rods = new InstancedMesh(new CylinderGeometry(1, 1, 1, 14, 1, true), this.material, this.bones.length);
    for (const mesh of [this.balls, this.rods]) {
      mesh.frustumCulled = false; // the instances move, the mesh does not
      this.add(mesh);
    }
    this.matrix4 = new Matrix4();
    this.colour([]);
  }

  sideColour(joint) {
    return this.spared[joint] ? SPARED : (SIDES[this.sides[joint]] ?? SIDES.middle);
  }

  /** Colour by side; the joints by their values where there are values. */
  colour(values) {
    const highest = Math.max(...values, 0);
    this.hasValues = values.length > 0;
    const paint = new Color();
    this.parents.forEach((_, joint) => {
      const side = this.sideColour(joint);
      const own = this.hasValues ? shade(highest > 0 ? values[joint] / highest : 0) : side;
      this.balls.setColorAt(joint, paint.setHex(this.isGhost ? GHOST : own));
    });
    this.bones.forEach(([, joint], bone) => {
      this.rods.setColorAt(bone, paint.setHex(this.isGhost ? GHOST : this.sideColour(joint)));
    });
    this.balls.instanceColor.needsUpdate = true;
    this.rods.instanceColor.needsUpdate = true;
  }

  radius(joint) {
    const side = this.sides[joint];
    return side === "left" || side === "right" ? BONE_M : TRUNK_M;
  }

  /** Take the pose that starts at a place in an array of x, y, z; where `mirror` is given, x becomes mirror - x. */
  pose(positions, start, mirror) {
    const across = (x) => (mirror === undefined ? x : mirror - x);
    const at = (joint) =>
      new Vector3(
        across(positions[start + 3 * joint]),
        positions[start + 3 * joint + 1],
        positions[start + 3 * joint + 2],
      );
    const turn = new Quaternion();
    this.parents.forEach((parent, joint) => {
      const centre = at(joint);
      let radius = this.radius(joint) * (this.hasValues ? 1.55 : 1);
      if (joint === this.headJoint) {
        // The joint lies at the base of the skull: the ball goes on in the direction of the neck.
        const neck = centre.clone().sub(at(parent)).normalize();
        centre.addScaledVector(neck, 0.7 * HEAD_M);
        radius = HEAD_M;
      }
      this.matrix4.compose(centre, turn, new Vector3(radius, radius, radius));
      this.balls.setMatrixAt(joint, this.matrix4);
    });
    this.bones.forEach(([parent, joint], bone) => {
      const from = at(parent);
      const along = at(joint).sub(from);
      const length = along.length();
      const thick = Math.min(this.radius(joint), this.radius(parent));
      turn.setFromUnitVectors(UP, length > 0 ? along.clone().divideScalar(length) : UP);
      this.matrix4.compose(from.addScaledVector(along, 0.5), turn, new Vector3(thick, length, thick));
      this.rods.setMatrixAt(bone, this.matrix4);
    });
    this.balls.instanceMatrix.needsUpdate = true;
    this.rods.instanceMatrix.needsUpdate = true;
  }

  dispose() {
    for (const mesh of [this.balls, this.rods]) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.material.dispose();
  }
}
