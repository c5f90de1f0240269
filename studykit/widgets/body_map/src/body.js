// The drawn body: it faces you, so the person's right is on your left, as when you stand before a patient.

/** Joint, what it hangs on, and its place in the drawing: to your right of the middle, and downwards. */
export const JOINTS = [
  ["pelvis", "", 0, 214],
  ["left_hip", "pelvis", 25, 226],
  ["right_hip", "pelvis", -25, 226],
  ["spine1", "pelvis", 0, 188],
  ["left_knee", "left_hip", 30, 312],
  ["right_knee", "right_hip", -30, 312],
  ["spine2", "spine1", 0, 162],
  ["left_ankle", "left_knee", 33, 392],
  ["right_ankle", "right_knee", -33, 392],
  ["spine3", "spine2", 0, 136],
  ["left_foot", "left_ankle", 43, 416],
  ["right_foot", "right_ankle", -43, 416],
  ["neck", "spine3", 0, 92],
  ["left_collar", "spine3", 23, 113],
  ["right_collar", "spine3", -23, 113],
  ["head", "neck", 0, 64],
  ["left_shoulder", "left_collar", 50, 119],
  ["right_shoulder", "right_collar", -50, 119],
  ["left_elbow", "left_shoulder", 72, 180],
  ["right_elbow", "right_shoulder", -72, 180],
  ["left_wrist", "left_elbow", 92, 236],
  ["right_wrist", "right_elbow", -92, 236],
  ["left_hand", "left_wrist", 100, 262],
  ["right_hand", "right_wrist", -100, 262],
];

/** How thick the drawn limb is that ends at a joint. */
export const WIDTHS = {
  spine1: 50,
  spine2: 52,
  spine3: 58,
  neck: 22,
  head: 24,
  collar: 24,
  shoulder: 26,
  elbow: 23,
  wrist: 19,
  hand: 17,
  hip: 36,
  knee: 34,
  ankle: 24,
  foot: 19,
};

const PARENTS = new Map(JOINTS.map(([name, parent]) => [name, parent]));

/** The words for a joint, from the person's own point of view. */
export function words(joint) {
  return joint.replace("_", " ").replace(/^spine(\d)$/, (_, number) => `spine, ${["lower", "middle", "upper"][number - 1]}`);
}

/** All joints that hang on a joint. */
export function beyond(joint) {
  const found = [joint];
  for (const [name, parent] of JOINTS) if (found.includes(parent)) found.push(name);
  return found.slice(1);
}

/** The joint itself, or the nearest that it hangs on, of which `values` says something. */
export function speaker(joint, values) {
  for (let at = joint; at; at = PARENTS.get(at)) if (at in values) return at;
  return undefined;
}

/** The state that a weight stands for. */
export function stateOf(weight) {
  if (weight >= 1) return "free";
  return weight <= 0 ? "spared" : "reduced";
}

/** Write an angular speed in both units. */
export function speedText(speed) {
  return `${speed.toFixed(1)} rad/s (${Math.round((speed * 180) / Math.PI)}°/s)`;
}
