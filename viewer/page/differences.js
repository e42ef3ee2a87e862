// Maps of the differences between two images.

/** The comparisons that a layer's component allows. `a`, `b`: lists of planes, one for scalars, three for colours. */
export const differenceKinds = [
    { id: 'signed', label: 'A − B', symmetric: true },
    { id: 'absolute', label: '|A − B|' },
    { id: 'relative', label: 'relative squared error' },
    { id: 'flip', label: 'FLIP' },
];

const kWeights = [0.2126, 0.7152, 0.0722];

/** A map with one number per pixel. signed: of the luminance; absolute: mean over the channels; relative: mean over the
 *  channels of (A - B)² / (B² + 0.01), the pixel's share of relMSE. */
export function differenceMap(kind, a, b) {
    const result = new Float32Array(a[0].length);
    for (let c = 0; c < a.length; ++c) {
        const [u, v] = [a[c], b[c]];
        const signedWeight = a.length === 3 ? kWeights[c] : 1;
        for (let i = 0; i < result.length; ++i) {
            const d = u[i] - v[i];
            result[i] += kind === 'signed' ? signedWeight * d
                : kind === 'absolute' ? Math.abs(d) / a.length
                    : (d * d) / (v[i] * v[i] + 0.01) / a.length;
        }
    }
    return result;
}
