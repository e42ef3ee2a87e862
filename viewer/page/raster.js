// Values to pixels: every function fills the bytes of an ImageData (R, G, B, A per pixel).

import { displayLevel, notANumberColor } from './color.js';

function put(bytes, i, r, g, b) {
    bytes[4 * i] = r;
    bytes[4 * i + 1] = g;
    bytes[4 * i + 2] = b;
    bytes[4 * i + 3] = 255;
}

/** Draws a linear colour times `gain`, as an sRGB screen shows it. */
export function paintColour(bytes, [red, green, blue], gain) {
    for (let i = 0; i < red.length; ++i) {
        const r = red[i], g = green[i], b = blue[i];
        if (Number.isNaN(r + g + b)) put(bytes, i, ...notANumberColor);
        else put(bytes, i, displayLevel(r * gain), displayLevel(g * gain), displayLevel(b * gain));
    }
}

/** Draws components in [-1, 1] as grey levels around the middle. */
export function paintDirection(bytes, [x, y, z]) {
    const level = (v) => Math.round(127.5 * (Math.min(1, Math.max(-1, v)) + 1));
    for (let i = 0; i < x.length; ++i) put(bytes, i, level(x[i]), level(y[i]), level(z[i]));
}

/** Draws values by a scale. range: { low, high, log }; scale: 256 colours from low to high. */
export function paintScalar(bytes, values, range, scale) {
    const place = rangePlace(range);
    for (let i = 0; i < values.length; ++i) {
        const v = values[i];
        if (Number.isNaN(v)) {
            put(bytes, i, ...notANumberColor);
            continue;
        }
        const c = 3 * Math.round(255 * Math.min(1, Math.max(0, place(v))));
        put(bytes, i, scale[c], scale[c + 1], scale[c + 2]);
    }
}

/** The function from a value to its place in the range, 0 at `low` and 1 at `high`. */
function rangePlace({ low, high, log }) {
    if (!log) {
        const width = high > low ? high - low : 1;
        return (v) => (v - low) / width;
    }
    const floor = Math.max(low, high * 1e-4, Number.MIN_VALUE);
    const decades = Math.log(high / floor) || 1;
    return (v) => (v > floor ? Math.log(v / floor) / decades : 0);
}

/** A range from the 0.5 to the 99.5 % quantile, or one even on both sides of zero where some are negative and
 *  `symmetric` is asked for: outliers don't decide what is seen. */
export function automaticRange(values, symmetric) {
    const step = Math.max(1, Math.floor(values.length / 50000));
    const sample = [];
    for (let i = 0; i < values.length; i += step) if (Number.isFinite(values[i])) sample.push(values[i]);
    if (sample.length === 0) return { low: 0, high: 1, log: false };
    sample.sort((a, b) => a - b);
    const at = (share) => sample[Math.round(share * (sample.length - 1))];
    const [low, high] = [at(0.005), at(0.995)];
    if (symmetric) {
        const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
        return { low: -size, high: size, log: false };
    }
    const from = low >= 0 && low < high / 2 ? 0 : low;
    return { low: from, high: high > from ? high : from + 1, log: false };
}
