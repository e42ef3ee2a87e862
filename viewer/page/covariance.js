// The covariance of a pixel in words and units, as `covtrace inspect --pixel` tells it.

import { formatNumber } from './format.js';

/** The axes of the 5x5 covariance. `scale` turns its unit into the one that is shown: the lens axes count
 *  in radii of the aperture, of which it is two wide. */
export const axes = [
    { name: 'image x', unit: 'cycles/pixel', scale: 1 },
    { name: 'image y', unit: 'cycles/pixel', scale: 1 },
    { name: 'lens x', unit: 'cycles/aperture', scale: 2 },
    { name: 'lens y', unit: 'cycles/aperture', scale: 2 },
    { name: 'time', unit: 'cycles/shutter', scale: 1 },
];

/** Place of entry (row, column) in the 15 that are stored: rows of the upper triangle. */
export function symmetricIndex(row, column) {
    const [i, j] = row <= column ? [row, column] : [column, row];
    return 5 * i - (i * (i - 1)) / 2 + (j - i);
}

/** Standard deviation of the spectrum along an axis, in its unit. */
export function bandwidth(values, axis) {
    return axes[axis].scale * Math.sqrt(Math.max(0, values[symmetricIndex(axis, axis)]));
}

// Cycles over the whole aperture or shutter below which nothing varies: such a part of a wave changes by less than a
// third of its amplitude.
const kStill = 0.05;

export function bandwidthWords(axis, value) {
    if (axis < 2) {
        if (value < 0.001) return 'does not vary';
        if (value >= 0.5) return 'finer than the pixels can show (0.5)';
        return `one period in ${formatNumber(1 / value)} pixels`;
    }
    const where = axis < 4 ? 'across the aperture' : 'while the shutter is open';
    if (value < kStill) return axis < 4 ? `in focus: constant ${where}` : `at rest: constant ${where}`;
    return `${formatNumber(value)} periods ${where}`;
}

/** Principal axes of a symmetric 2x2: standard deviations and the angle of the longer axis in degrees in
 *  (-90, 90], counter-clockwise on the screen from the direction of x (pixel y points down). */
export function ellipse(xx, xy, yy) {
    const mean = (xx + yy) / 2;
    const radius = Math.hypot((xx - yy) / 2, xy);
    const angle = radius > 0 ? (-Math.atan2(xy, (xx - yy) / 2) / 2) * (180 / Math.PI) : 0;
    return {
        major: Math.sqrt(Math.max(0, mean + radius)),
        minor: Math.sqrt(Math.max(0, mean - radius)),
        angle: angle <= -90 ? angle + 180 : angle + 0,
    };
}
