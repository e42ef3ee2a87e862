/// Rough glass under a film: the share of the light that single scattering keeps, by colour.
///
/// What facets reflect and what they transmit is masked by other facets in different measure, and a
/// film moves light from one to the other. Let s(u) be the share that facets under the film reflect
/// of light with the cosine u on the film's side; r and t the shares of reflected and of
/// transmitted light that no other facet masks. Of the light along wo
///
///    E(wo) = mean of t + s (r - t) over the facets that it meets = A(wo) + integral K(wo, u) s(u)
///    du
///
/// is kept, where A and K hang on the index and the roughness, and only s on the film. FilmKernel
/// holds them, of either side of the border, by the quadrature of rough coats; the table of any
/// film is a product with it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bsdf/coat_table.h"
#include "core/error.h"

namespace covtrace {

/// A and K of borders of one index, for all rows and nodes of a CoatTable.
class FilmKernel {
  public:
    static constexpr int kCosines = 64;  ///< of s, evenly spaced over sqrt(u) in [0, 1]
    /// The share s(u) at the cosines, by colour.
    using Reflected = std::array<Rgb, kCosines>;

    /// Takes about 30 ms and 0.6 MB. `eta`: inside over outside, > 0.
    explicit FilmKernel(float eta);
    float eta() const { return eta_; }
    /// The share E of light from inside or from outside.
    Rgb kept(bool inside, int row, int node, const Reflected& s) const;
    /// The cosine u of a node.
    static float cosine(int node) { return sqr(static_cast<float>(node) / (kCosines - 1)); }

  private:
    /// K is that of linear interpolation between the cosines.
    struct Linear {
        float constant = 1;  ///< A
        std::array<float, kCosines> weights{};
    };
    Linear rough(bool inside, float alpha, float cos_o) const;

    float eta_;
    /// By the side, outside first, then row, then node.
    std::vector<Linear> linear_;
};

/// E of glass under one film that covers it all, of one thickness or of all.
class FilmTable {
  public:
    /// The table of a film of one `thickness`, nm, takes 0.2 ms and 0.03 MB; without one it has
    /// nodes of the thickness, up to where interference ends, between which E is interpolated by
    /// Catmull-Rom, and takes 30 ms and 6 MB. `film_eta`: index of the film over that of the
    /// outside. Throws Error(limit) at `where` if the memory is not there.
    FilmTable(const FilmKernel& kernel, float film_eta, std::optional<float> thickness,
              const SourceLocation& where = {});
    float eta() const { return eta_; }
    float film_eta() const { return film_eta_; }
    std::optional<float> thickness() const { return thickness_; }

    /// The share E for light from inside or outside with the cosine `cos_theta` > 0; `row`:
    /// CoatTable::row_of. A table of one thickness has that one's for any `thickness`.
    Rgb kept(bool inside, float row, float cos_theta, float thickness) const;

  private:
    /// The shares E of one thickness, from outside and from inside.
    using Slice = std::array<CoatTable::PerAngle<Rgb>, 2>;
    static Slice slice_of(const FilmKernel& kernel, float film_eta, float thickness);

    float eta_, film_eta_;
    std::optional<float> thickness_;
    float step_ = 0;  ///< nm between the slices
    /// That of `thickness_`, or those without a film, of the thinnest one, and of each step.
    std::vector<Slice> slices_;
};

/// The tables of all films over a scene's glass, one for each distinct set of constants.
class FilmTables {
  public:
    /// Makes the table where it does not exist yet; the reference lives as long as this object.
    /// Throws as FilmTable does.
    const FilmTable& get(float eta, float film_eta, std::optional<float> thickness,
                         const SourceLocation& where = {});

  private:
    std::vector<std::unique_ptr<const FilmKernel>> kernels_;
    std::vector<std::unique_ptr<const FilmTable>> tables_;
};

}  // namespace covtrace
