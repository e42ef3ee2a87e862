// Numbers as people read them.

/** A number with four significant digits; very small and very large values in powers of ten. */
export function formatNumber(value) {
    if (value === null || value === undefined) return '';
    if (Number.isNaN(value)) return 'NaN';
    if (!Number.isFinite(value)) return value > 0 ? 'infinite' : '-infinite';
    const size = Math.abs(value);
    if (value === 0) return '0';
    if (size >= 1e5 || size < 1e-4) return value.toExponential(3);
    return String(Number(value.toPrecision(4)));
}

/** A number with three significant digits in few letters, for matrices. */
export function formatBriefly(value) {
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e4)) return value.toExponential(1);
    return String(Number(value.toPrecision(3)));
}

/** A number with all digits that a 32-bit float holds: as many as tell two values apart. */
export function formatExactly(value) {
    return Number.isFinite(value) ? String(Number(value.toPrecision(9))) : formatNumber(value);
}
