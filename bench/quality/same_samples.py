"""The seed with which `uniform` takes the samples of `hybrid`."""
BITS = (1 << 64) - 1


def mixed(v):
    """mix_bits of src/core/hash.h."""
    v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9 & BITS
    v = (v ^ v >> 27) * 0x94D049BB133111EB & BITS
    return v ^ v >> 31


def combined(a, b):
    """hash_combine of src/core/hash.h."""
    return mixed(a * 0x9E3779B97F4A7C15 + b + 0x632BE59BD9B4E019 & BITS)


def seed_of_halves(seed):
    """hybrid_seed of src/render/hybrid_film.h: what `hybrid` with `seed` gives to the sampler."""
    return combined(combined(seed, 0x68616C66), 0)
