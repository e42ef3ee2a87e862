#include "render/methods/idle_options.h"

namespace covtrace {

std::vector<std::string> idle_options(const RenderOptions& o, bool insists_on_denoiser) {
    const RenderOptions standard;
    std::vector<std::string> idle;
    const auto require = [&](bool is_given, const std::string& name, bool counts,
                             const std::string& methods) {
        if (is_given && !counts)
            idle.push_back(name + " changes nothing: it is for the method " + methods +
                           ", and this is " + std::string(name_of(o.method)));
    };
    const bool is_covariance = o.method == Method::covariance;
    require(o.density != standard.density, "--density", is_covariance, "covariance");
    require(o.filter != standard.filter, "--filter", is_covariance, "covariance");
    require(o.progressive, "--progressive", is_covariance, "covariance");
    const bool is_hybrid = o.method == Method::hybrid;
    require(o.even_counts, "--even-counts", is_hybrid, "hybrid");
    require(insists_on_denoiser, "--denoiser", is_hybrid, "hybrid");
    require(o.denoiser_quality.has_value(), "--denoiser-quality", is_hybrid, "hybrid");
    const bool predicts = o.method != Method::uniform;
    const std::string both = "covariance or hybrid";
    require(o.cov_spp.has_value(), "--cov-spp", predicts, both);
    require(o.occlusion != standard.occlusion, "--occlusion", predicts, both);
    require(o.brdf_covariance != standard.brdf_covariance, "--brdf-covariance", predicts, both);
    require(o.texture_bandwidth != standard.texture_bandwidth, "--texture-bandwidth", predicts,
            both);
    if (o.voxels != standard.voxels && !(predicts && asks_grid(o.occlusion)))
        idle.emplace_back("--voxels changes nothing: only --occlusion grid and voxels have a grid");
    return idle;
}

}  // namespace covtrace
