#include "pbrt/brdf_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "colour/spectrum.h"
#include "scene/names.h"

namespace covtrace {

namespace {

static_assert(std::endian::native == std::endian::little, "tensor files are little-endian");

using Refuse = std::function<Error(const std::string&)>;

/// An array of numbers in the file.
struct Field {
    uint8_t type = 0;
    std::vector<uint64_t> shape;
    std::string_view bytes;
};
constexpr uint8_t kByte = 1, kFloat = 10;  // types of the file format

/// Sizes of the types, by their numbers from 1.
constexpr std::array<uint64_t, 11> kTypeSizes{1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};

class TensorFile {
  public:
    TensorFile(std::string_view bytes, const Refuse& refuse) : all_(bytes), refuse_(refuse) {
        constexpr std::string_view magic("tensor_file\0", 12);
        if (take(magic.size()) != magic) throw refuse_("it is no tensor file");
        const auto major = number<uint8_t>(), minor = number<uint8_t>();
        if (major != 1 || minor != 0)
            throw refuse_("its version is " + std::to_string(major) + "." + std::to_string(minor) +
                          "; expected 1.0");
        const auto count = number<uint32_t>();
        for (uint32_t i = 0; i < count; ++i) read_field();
    }

    /// The numbers of a field with this many dimensions; none of them is NaN or infinite.
    std::vector<float> floats(const std::string& name, size_t dimensions) const {
        const Field& f = field(name);
        if (f.type != kFloat || f.shape.size() != dimensions)
            throw refuse_("field " + in_quotes(name) +
                          " is not made of single precision numbers in " +
                          std::to_string(dimensions) + " dimensions");
        std::vector<float> values(f.bytes.size() / sizeof(float));
        std::memcpy(values.data(), f.bytes.data(), f.bytes.size());
        if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
            throw refuse_("field " + in_quotes(name) + " has numbers that are not finite");
        return values;
    }
    const std::vector<uint64_t>& shape(const std::string& name) const { return field(name).shape; }
    bool is_set(const std::string& name) const {
        const Field& f = field(name);
        return f.type == kByte && f.bytes.size() == 1 && f.bytes[0] != 0;
    }

  private:
    const Field& field(const std::string& name) const {
        const auto it = fields_.find(name);
        if (it == fields_.end()) throw refuse_("it has no field " + in_quotes(name));
        return it->second;
    }
    std::string_view take(size_t bytes) {
        if (bytes > all_.size() - at_) throw refuse_("it ends too early");
        at_ += bytes;
        return all_.substr(at_ - bytes, bytes);
    }
    template <typename T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    void read_field() {
        const std::string name(take(number<uint16_t>()));
        const auto dimensions = number<uint16_t>();
        Field f;
        f.type = number<uint8_t>();
        const auto offset = number<uint64_t>();
        if (f.type < 1 || f.type > kTypeSizes.size())
            throw refuse_("field " + in_quotes(name) + " has an unknown type");
        uint64_t size = kTypeSizes[f.type - 1u];
        for (int i = 0; i < dimensions; ++i) {
            const auto side = number<uint64_t>();
            if (side == 0 || side > all_.size() / size)
                throw refuse_("field " + in_quotes(name) + " is larger than the file, or empty");
            size *= side;
            f.shape.push_back(side);
        }
        if (offset > all_.size() || size > all_.size() - offset)
            throw refuse_("field " + in_quotes(name) + " lies outside of the file");
        f.bytes = all_.substr(offset, size);
        fields_[name] = f;
    }

    std::string_view all_;
    size_t at_ = 0;
    const Refuse& refuse_;
    std::map<std::string, Field> fields_;
};

/// The numbers of a field whose last two dimensions are a table's, and whose first ones these.
BrdfTables<float> tables(const TensorFile& file, const std::string& name,
                         const std::vector<uint64_t>& before, const Refuse& refuse) {
    const std::vector<uint64_t>& shape = file.shape(name);
    if (shape.size() != before.size() + 2 ||
        !std::equal(before.begin(), before.end(), shape.begin()))
        throw refuse("field " + in_quotes(name) + " does not have a table for each direction");
    const uint64_t height = shape[before.size()], width = shape[before.size() + 1];
    if (height < 2 || width < 2 || height > 65536 || width > 65536)
        throw refuse("the tables of field " + in_quotes(name) +
                     " have an impossible size; expected at least 2 by 2");
    BrdfTables<float> t{int(width), int(height), file.floats(name, shape.size())};
    // Densities and areas; only the factors of colours may be negative, by the noise of measurement
    if (name != "spectra")
        for (float& v : t.values) v = std::max(v, 0.0f);
    return t;
}

/// Increasing numbers.
std::vector<float> nodes(const TensorFile& file, const std::string& name, const Refuse& refuse) {
    std::vector<float> values = file.floats(name, 1);
    for (size_t i = 1; i < values.size(); ++i)
        if (!(values[i] > values[i - 1]))
            throw refuse("the numbers of field " + in_quotes(name) + " do not increase");
    return values;
}

/// Colours that each wavelength adds: the observer looks at values on straight lines
/// between the wavelengths, and at the first and the last one beyond them.
std::vector<Rgb> colour_weights(const std::vector<float>& wavelengths) {
    std::vector<std::array<double, 3>> sums(wavelengths.size());
    const auto add = [&](size_t i, double share, const ObserverSample& s) {
        for (size_t c = 0; c < 3; ++c) sums[i][c] += share * s.weight[c];
    };
    for (const ObserverSample& s : observer_samples()) {
        const auto above = std::upper_bound(wavelengths.begin(), wavelengths.end(), s.wavelength);
        const auto i = size_t(above - wavelengths.begin());
        if (i == 0 || i == wavelengths.size()) {
            add(i == 0 ? 0 : i - 1, 1, s);
            continue;
        }
        const double share = (s.wavelength - double(wavelengths[i - 1])) /
                             (double(wavelengths[i]) - double(wavelengths[i - 1]));
        add(i - 1, 1 - share, s);
        add(i, share, s);
    }
    std::vector<Rgb> weights;
    for (const auto& w : sums) weights.push_back({float(w[0]), float(w[1]), float(w[2])});
    return weights;
}

/// Makes colours of the spectra: of the tables of each direction, one behind the other for each
/// wavelength.
BrdfTables<Rgb> colours(const BrdfTables<float>& spectra, const std::vector<float>& wavelengths) {
    const std::vector<Rgb> weights = colour_weights(wavelengths);
    const size_t table = size_t(spectra.width) * size_t(spectra.height);
    const size_t directions = spectra.values.size() / (table * weights.size());
    BrdfTables<Rgb> result{spectra.width, spectra.height, std::vector<Rgb>(directions * table)};
    const float* value = spectra.values.data();
    for (size_t d = 0; d < directions; ++d)
        for (const Rgb& weight : weights)
            for (size_t i = 0; i < table; ++i)
                result.values[d * table + i] += std::max(0.0f, *value++) * weight;
    return result;
}

}  // namespace

std::shared_ptr<const BrdfTensor> read_brdf(std::string_view bytes,
                                            const std::filesystem::path& path,
                                            const SourceLocation& where) {
    const Refuse refuse = [&](const std::string& why) {
        return Error(ErrorKind::scene, where, "BRDF file " + in_quotes(path.string()) + ": " + why);
    };
    const TensorFile file(bytes, refuse);
    auto brdf = std::make_shared<BrdfTensor>();
    brdf->file = path;
    brdf->phi = nodes(file, "phi_i", refuse);
    brdf->theta = nodes(file, "theta_i", refuse);
    if (!brdf->is_isotropic()) {
        const float covered = brdf->phi.back() - brdf->phi.front();
        if (std::lround(2 * kPi / covered) != 1)
            throw refuse("it holds a part of all azimuths only; expected all of them");
    }
    if (!file.is_set("jacobian"))
        throw refuse("its spectra are no factors on microfacets (field \"jacobian\" is 0)");
    const uint64_t p = brdf->phi.size(), t = brdf->theta.size();
    const std::vector<float> wavelengths = nodes(file, "wavelengths", refuse);
    brdf->normals = tables(file, "ndf", {}, refuse);
    brdf->areas = tables(file, "sigma", {}, refuse);
    brdf->visible_normals = tables(file, "vndf", {p, t}, refuse);
    brdf->luminance = tables(file, "luminance", {p, t}, refuse);
    const BrdfTables<float> spectra = tables(file, "spectra", {p, t, wavelengths.size()}, refuse);
    if (spectra.width != brdf->luminance.width || spectra.height != brdf->luminance.height)
        throw refuse("its spectra and luminances have tables of different sizes");
    brdf->colours = colours(spectra, wavelengths);
    return brdf;
}

}  // namespace covtrace
