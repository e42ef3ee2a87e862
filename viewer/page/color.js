// Linear light to display values as covtrace writes a PNG, and the colour scales of single numbers.

const encodeSrgb = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * Math.pow(v, 1 / 2.4) - 0.055);
const decodeSrgb = (v) => (v <= 0.04045 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4));

// Level k is shown from thresholds[k] on. A table over the linear value finds a level at most two below.
const thresholds = Float64Array.from({ length: 257 }, (_, k) =>
    k === 0 ? -Infinity : k === 256 ? Infinity : decodeSrgb((k - 0.5) / 255));
const kCells = 4096;
const firstLevel = Uint8Array.from({ length: kCells }, (_, i) =>
    Math.max(0, Math.floor(255 * encodeSrgb(i / kCells) + 0.5) - 1));

/** 8-bit sRGB of a linear value, clamped to [0, 1]; NaN gives 0. */
export function displayLevel(v) {
    if (!(v > 0)) return 0;
    if (v >= 1) return 255;
    let level = firstLevel[Math.floor(v * kCells)];
    while (v >= thresholds[level + 1]) ++level;
    return level;
}

/** OKLCH (Ottosson 2020; hue in degrees) to bytes, clipped to the gamut of sRGB. */
function oklch(lightness, chroma, hue) {
    const a = chroma * Math.cos((hue * Math.PI) / 180);
    const b = chroma * Math.sin((hue * Math.PI) / 180);
    const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
    return [
        displayLevel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
        displayLevel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        displayLevel(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
    ];
}

const makeScale = (color) => Uint8Array.from({ length: 256 * 3 }, (_, i) => color(Math.floor(i / 3) / 255)[i % 3]);

/** A scale even in lightness, so that it also reads in grey: dark violet, blue, green, yellow. */
export const sequentialScale = makeScale((t) => oklch(0.16 + 0.78 * t, 0.08 + 0.09 * t, 305 - 205 * t));
/** A scale around zero: blue below, dark at zero (the middle), orange above. */
export const divergingScale = makeScale((t) => {
    const size = Math.abs(2 * t - 1);
    return oklch(0.17 + 0.7 * size, 0.15 * Math.sqrt(size), t > 0.5 ? 55 : 250);
});
export const greyScale = makeScale((t) => Array(3).fill(Math.round(255 * t)));

/** Colour of values that are not numbers, which stands out in every scale. */
export const notANumberColor = [255, 0, 255];
