// The values of the images as they stand in the page: base64 of deflated byte planes of 16- or 32-bit floats.

let halves = null;

/** A table of all 65536 half-precision numbers. */
function halfTable() {
    if (halves) return halves;
    halves = new Float32Array(65536);
    for (let bits = 0; bits < 65536; ++bits) {
        const exponent = (bits >> 10) & 31;
        const fraction = bits & 1023;
        const size = exponent === 0 ? fraction * 2 ** -24
            : exponent < 31 ? (1 + fraction / 1024) * 2 ** (exponent - 15)
                : fraction ? NaN : Infinity;
        halves[bits] = bits & 0x8000 ? -size : size;
    }
    return halves;
}

function fromBase64(text) {
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

async function inflate(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Puts the bytes of values together: byte k of value i stands at k * count + i. */
function unshuffle(bytes, count, size) {
    const values = new Uint8Array(count * size);
    for (let k = 0; k < size; ++k)
        for (let i = 0; i < count; ++i) values[i * size + k] = bytes[k * count + i];
    return values.buffer;
}

export class Planes {
    /** Prepares planes. descriptions[i].half: 16-bit floats; the text is in the element "plane-i". */
    constructor(descriptions, count) {
        this.descriptions = descriptions;
        this.count = count;
        this.values = new Map();
        this.pending = new Map();
    }

    /** The values as Float32Array, or undefined while they are not loaded. */
    get(index) {
        return this.values.get(index);
    }

    async load(indices) {
        await Promise.all(indices.map((i) => this.loadOne(i)));
    }

    async loadOne(index) {
        if (this.values.has(index)) return;
        if (!this.pending.has(index)) this.pending.set(index, this.decode(index));
        this.values.set(index, await this.pending.get(index));
        this.pending.delete(index);
    }

    async decode(index) {
        const element = document.getElementById(`plane-${index}`);
        const size = this.descriptions[index].half ? 2 : 4;
        const bytes = await inflate(fromBase64(element.textContent));
        if (bytes.length !== this.count * size) throw new Error(`plane ${index} is damaged`);
        element.textContent = '';
        const buffer = unshuffle(bytes, this.count, size);
        if (size === 4) return new Float32Array(buffer);
        const table = halfTable();
        return Float32Array.from(new Uint16Array(buffer), (bits) => table[bits]);
    }
}
