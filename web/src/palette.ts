// Colours. They are told apart without red and green, and whatever a colour says is also said by a shape or a word.
// Amber belongs to the person's own goal, and flames are the only other warm thing.

export const SKY = { top: '#050914', high: '#0c1733', low: '#1b345f', horizon: '#4c6f9f' } as const;
export const STAR = '#dfe8ff';
export const PLANET = { lit: '#b9c8ea', mid: '#6f86b8', dark: '#1a2747' } as const;
/** From the farthest to the nearest; the nearer the darker. */
export const RANGES = ['#34548a', '#25416e', '#182d52'] as const;
export const RANGE_FOOT = '#3d5f90';
export const GROUND = { top: '#3d4a68', deep: '#121a2e', edge: '#d3e0fa', rim: '160, 190, 240' } as const;
export const BODY = { light: '#fbfcff', mid: '#c3cee6', dark: '#66759b', edge: '#1a2440', belt: '#2c3a60' } as const;
export const LIMB = { light: '#dbe3f5', dark: '#7483a9', edge: '#1a2440' } as const;
export const GLASS = { light: '#d5f4ff', mid: '#4aa8de', dark: '#163f66', edge: '#1a2440' } as const;
export const GOAL = { edge: '#d5e0fa', fill: 'rgba(190, 208, 250, 0.16)', ink: '#c9d6f2' } as const;
export const OWN = { edge: '#ffc23d', fill: '#ffb000', ink: '#ffc23d', light: '255, 176, 0' } as const;
export const CUE = '#8fdcff';
export const TRAIL = '191, 210, 245';
export const CORRECTED = '255, 176, 0';
/** A flame from its heart outwards. */
export const FLAME = { heart: '255, 250, 232', middle: '255, 186, 84', edge: '255, 104, 48' } as const;
export const DUST = '164, 178, 208';
/** What a rotor throws down. */
export const AIR = '196, 220, 255';
