// The picture: floor, light, camera and the figures, drawn only when something changed.
import {
  AmbientLight,
  BufferGeometry,
  Color,
  DirectionalLight,
  Float32BufferAttribute,
  LineBasicMaterial,
  LineSegments,
  PerspectiveCamera,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { element } from "./dom.js";
import { Figure } from "./figure.js";

const NO_PICTURE =
  "This browser cannot draw in 3D (WebGL is not available). Everything else here works; " +
  "to see the figure, switch on hardware acceleration or use another browser.";

/** A grid of one metre; each side of a square is a line of its own, so that none reaches behind the camera. */
function grid(half, colour) {
  const points = [];
  for (let across = -half; across <= half; across += 1) {
    for (let along = -half; along < half; along += 1) {
      points.push(across, 0, along, across, 0, along + 1);
      points.push(along, 0, across, along + 1, 0, across);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.22 }));
}

export class Stage {
  constructor(signal) {
    this.element = element("div", { class: "sk-stage" });
    this.figures = [];
    this.centre = new Vector3(0, 0.9, 0);
    this.reach = 1;
    this.isFollowing = false;
    const canvas = element("canvas", {
      class: "sk-canvas",
      tabindex: 0,
      role: "img",
      "aria-label": "Moving figure. Drag to turn, or hold Shift and press the arrow keys; R resets the view.",
    });
    const context = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!context) {
      this.element.append(element("p", { class: "sk-sorry", role: "alert" }, NO_PICTURE));
      return;
    }
    this.element.append(canvas);
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, context, alpha: true, antialias: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 0.05, 200);
    this.lights();
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = 0.62 * Math.PI; // from a little below the floor to straight above
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 30;
    this.controls.enableZoom = false; // until the picture is chosen: the page must scroll over it
    canvas.addEventListener("focus", () => (this.controls.enableZoom = true), { signal });
    canvas.addEventListener("blur", () => (this.controls.enableZoom = false), { signal });
    canvas.addEventListener("pointerdown", () => canvas.focus({ preventScroll: true }), { signal });
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault(), { signal });
    canvas.addEventListener("webglcontextrestored", () => this.draw(), { signal });
    this.controls.addEventListener("change", () => this.draw());
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(this.element);
    this.theme = new MutationObserver(() => this.dress());
    this.theme.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-name", "class"] });
    this.resetView();
    signal.addEventListener("abort", () => this.dispose());
  }

  get canDraw() {
    return this.renderer !== undefined;
  }

  lights() {
    this.scene.add(new AmbientLight(0xffffff, 1.5));
    for (const [x, y, z, strength] of [
      [2, 5, 4, 1.8],
      [-4, 3, -3, 0.7],
    ]) {
      const light = new DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      this.scene.add(light);
    }
  }

  /** Draw the floor in the colours of the page. */
  dress() {
    if (!this.canDraw) return;
    this.removeFloor();
    const ink = new Color(getComputedStyle(this.element).color);
    this.floor = grid(Math.min(Math.ceil(this.reach + 2), 25), ink);
    this.floor.position.set(Math.round(this.centre.x), 0, Math.round(this.centre.z));
    this.scene.add(this.floor);
    this.draw();
  }

  removeFloor() {
    if (!this.floor) return;
    this.scene.remove(this.floor);
    this.floor.geometry.dispose();
    this.floor.material.dispose();
    this.floor = undefined;
  }

  /** Put figures on the stage: a list of { body, values, isGhost }, and how far they move. */
  show(figures, extent) {
    this.extent = extent;
    this.centre.set(extent.x, 0.9, extent.z);
    this.reach = extent.reach;
    if (!this.canDraw) return;
    for (const figure of this.figures) {
      this.scene.remove(figure);
      figure.dispose();
    }
    this.figures = figures.map(({ body, values, isGhost }) => {
      const figure = new Figure(body, isGhost);
      figure.colour(values);
      this.scene.add(figure);
      return figure;
    });
    this.resetView();
    this.dress();
  }

  /** Keep the camera beside the first figure, or let it rest. */
  follow(point) {
    if (!this.canDraw || !this.isFollowing) return;
    const shift = new Vector3(point[0] - this.controls.target.x, 0, point[1] - this.controls.target.z);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
  }

  /** See all of the motion from the front. */
  resetView() {
    if (!this.canDraw) return;
    const distance = Math.min(2.2 + 1.1 * (this.isFollowing ? 0.6 : this.reach), 14);
    this.controls.target.copy(this.centre);
    this.camera.position.set(this.centre.x, 0.9 + 0.22 * distance, this.centre.z + distance);
    this.controls.update();
    this.draw();
  }

  /** Turn the camera about the figure, rad. */
  turn(around, upwards) {
    if (!this.canDraw) return;
    const arm = new Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    arm.theta += around;
    arm.phi = Math.min(Math.max(arm.phi - upwards, 0.05), this.controls.maxPolarAngle);
    this.camera.position.setFromSpherical(arm).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dress(); // now in the page, the stage knows the page's colours

  }

  /** Draw once, when the browser next draws. */
  draw() {
    if (!this.canDraw || this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      if (this.renderer) this.renderer.render(this.scene, this.camera);
    });
  }

  dispose() {
    if (!this.canDraw) return;
    this.resizing.disconnect();
    this.theme.disconnect();
    this.controls.dispose();
    for (const figure of this.figures) figure.dispose();
    this.removeFloor();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // a page may hold few of these
    this.renderer = undefined;
  }
}
