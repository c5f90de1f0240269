// Colours that every common kind of colour vision tells apart (Okabe and Ito), and a scale for values.

export const SIDES = { left: 0x0072b2, right: 0xe69f00, middle: 0x9a9a9a };
export const GHOST = 0xcc79a7;
export const SPARED = 0x009e73;

// Anchors of viridis without its darkest part, which would vanish on a dark page.
const SCALE = [0x3b528b, 0x31688e, 0x287c8e, 0x21918c, 0x20a486, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725];

/** The colour of a share between 0 and 1. */
export function shade(share) {
  const place = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1);
  const below = Math.min(Math.floor(place), SCALE.length - 2);
  const mix = place - below;
  let colour = 0;
  for (const shift of [16, 8, 0]) {
    const from = (SCALE[below] >> shift) & 255;
    const to = (SCALE[below + 1] >> shift) & 255;
    colour |= Math.round(from + mix * (to - from)) << shift;
  }
  return colour;
}

/** Write a colour as CSS does. */
export function css(colour) {
  return `#${colour.toString(16).padStart(6, "0")}`;
}

/** The whole scale as a CSS gradient. */
export const gradient = `linear-gradient(to right, ${SCALE.map(css).join(", ")})`;
