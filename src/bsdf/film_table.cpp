#include "bsdf/film_table.h"

#include "bsdf/facet_quadrature.h"
#include "core/catmull_rom.h"
#include "core/memory_limit.h"

namespace covtrace {
namespace {

/// Nanometres of optical path along the normal from one thickness to the next, a ninth of a wave of
/// blue light, and the number of steps. After 8000 nm the light of a film's borders is out of step
/// at all angles, so that it has no colours.
constexpr float kPathStep = 40;
constexpr int kSteps = 200;

size_t index_of(bool inside, int row, int node) {
    return static_cast<size_t>((inside * CoatTable::kRows + row) * CoatTable::kNodes + node);
}

}  // namespace

FilmKernel::FilmKernel(float eta) : eta_(eta), linear_(index_of(true, CoatTable::kRows, 0)) {
    // A smooth border, and light along a border, of which the facets reflect all, keep everything.
    for (const bool inside : {false, true})
        for (int row = 1; row < CoatTable::kRows; ++row)
            for (int node = 1; node < CoatTable::kNodes; ++node)
                linear_[index_of(inside, row, node)] =
                    rough(inside, sqr(static_cast<float>(row) / (CoatTable::kRows - 1)),
                          sqr(static_cast<float>(node) / (CoatTable::kNodes - 1)));
}

FilmKernel::Linear FilmKernel::rough(bool inside, float alpha, float cos_o) const {
    Linear sum{.constant = 0};
    for_each_facet(inside ? 1 / eta_ : eta_, alpha, cos_o, [&](const MetFacet& facet) {
        if (facet.fresnel.reflectance >= 1) {
            sum.constant += facet.weight * facet.kept_reflected;
            return;
        }
        sum.constant += facet.weight * facet.kept_transmitted;
        const float u = inside ? facet.fresnel.cos_t : facet.cosine;
        const float x = std::sqrt(clamp01(u)) * (kCosines - 1);
        const int i = std::min(static_cast<int>(x), kCosines - 2);
        const float t = x - static_cast<float>(i);
        const float turned = facet.weight * (facet.kept_reflected - facet.kept_transmitted);
        sum.weights[static_cast<size_t>(i)] += turned * (1 - t);
        sum.weights[static_cast<size_t>(i) + 1] += turned * t;
    });
    return sum;
}

Rgb FilmKernel::kept(bool inside, int row, int node, const Reflected& s) const {
    const Linear& linear = linear_[index_of(inside, row, node)];
    Rgb sum(linear.constant);
    for (size_t i = 0; i < s.size(); ++i) sum += linear.weights[i] * s[i];
    return sum;
}

FilmTable::FilmTable(const FilmKernel& kernel, float film_eta, std::optional<float> thickness,
                     const SourceLocation& where)
    : eta_(kernel.eta()), film_eta_(film_eta), thickness_(thickness) {
    if (thickness) {
        slices_.push_back(slice_of(kernel, film_eta, *thickness));
        return;
    }
    step_ = kPathStep / (2 * film_eta);
    const MemoryReservation room((kSteps + 2) * sizeof(Slice),
                                 "tables of a film of varying thickness", where);
    slices_.reserve(kSteps + 2);
    slices_.push_back(slice_of(kernel, film_eta, 0));
    slices_.push_back(slice_of(kernel, film_eta, kThinnestFilm));
    for (int i = 1; i <= kSteps; ++i)
        slices_.push_back(slice_of(kernel, film_eta, static_cast<float>(i) * step_));
}

FilmTable::Slice FilmTable::slice_of(const FilmKernel& kernel, float film_eta, float thickness) {
    const ThinFilm film{1, film_eta, thickness};
    FilmKernel::Reflected reflected;
    for (int i = 0; i < FilmKernel::kCosines; ++i)
        reflected[static_cast<size_t>(i)] = film_reflectance(
            film, FilmKernel::cosine(i), Rgb(sqr((kernel.eta() - 1) / (kernel.eta() + 1))));
    Slice slice;
    for (const bool inside : {false, true})
        for (int row = 0; row < CoatTable::kRows; ++row) {
            auto& nodes = slice[inside][static_cast<size_t>(row)];
            for (int i = 0; i < CoatTable::kNodes; ++i)
                nodes[static_cast<size_t>(i) + 1] = kernel.kept(inside, row, i, reflected);
            CoatTable::continue_past_ends(nodes);
        }
    return slice;
}

Rgb FilmTable::kept(bool inside, float row, float cos_theta, float thickness) const {
    const CoatTable::Place place(row, cos_theta);
    const auto of_slice = [&](int i) {
        return place.interpolate(slices_[static_cast<size_t>(i)][inside],
                                 [](const Rgb& kept) { return kept; });
    };
    if (thickness_) return of_slice(0);
    if (thickness < kThinnestFilm) return lerp(thickness / kThinnestFilm, of_slice(0), of_slice(1));
    const float x = std::min(thickness / step_, static_cast<float>(kSteps));
    const int i = std::min(static_cast<int>(x), kSteps - 1);
    const std::array<float, 4> weights = catmull_rom_weights(x - static_cast<float>(i));
    Rgb sum;
    for (int k = 0; k < 4; ++k)
        sum += weights[static_cast<size_t>(k)] * of_slice(1 + std::clamp(i - 1 + k, 0, kSteps));
    return sum;
}

const FilmTable& FilmTables::get(float eta, float film_eta, std::optional<float> thickness,
                                 const SourceLocation& where) {
    for (const auto& table : tables_)
        if (table->eta() == eta && table->film_eta() == film_eta && table->thickness() == thickness)
            return *table;
    const FilmKernel* kernel = nullptr;
    for (const auto& k : kernels_)
        if (k->eta() == eta) kernel = k.get();
    if (!kernel) kernel = kernels_.emplace_back(std::make_unique<const FilmKernel>(eta)).get();
    tables_.push_back(std::make_unique<const FilmTable>(*kernel, film_eta, thickness, where));
    return *tables_.back();
}

}  // namespace covtrace
