// Runs every vector of a file of test vectors through the public operators and compares with the
// outputs written there: |a - b| <= tol_rel * max(max|output|, max|input|).
//
// The file is COVTRACE_ORACLE where set, else oracle.json beside this source.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "oracle_operators.h"

namespace {

using oracle::Json;
using oracle::Numbers;

std::string oracle_path() {
    const char* path = std::getenv("COVTRACE_ORACLE");
    return path != nullptr && *path != '\0' ? path : COVTRACE_BUNDLED_ORACLE;
}

/// Content of the file; `error` says why it has none.
struct Oracle {
    Json content;
    std::vector<Json> vectors;
    std::string error;
};

const Oracle& load() {
    static const Oracle loaded = [] {
        Oracle result;
        std::ifstream file(oracle_path());
        if (!file) {
            result.error = "cannot open " + oracle_path();
            return result;
        }
        try {
            result.content = Json::parse(file);
            for (const Json& v : result.content.at("vectors")) result.vectors.push_back(v);
        } catch (const std::exception& e) {
            result.error = oracle_path() + ": " + e.what();
        }
        return result;
    }();
    return loaded;
}

double largest(const Numbers& values) {
    double most = 0;
    for (const double x : values) most = std::max(most, std::abs(x));
    return most;
}

void expect_close(const Numbers& ours, const Numbers& stated, double tolerance,
                  const std::string& what) {
    ASSERT_EQ(ours.size(), stated.size()) << what;
    for (std::size_t i = 0; i < ours.size(); ++i)
        // The condition is written so that a NaN on either side fails.
        EXPECT_TRUE(std::abs(ours[i] - stated[i]) <= tolerance)
            << what << ", entry " << i << ": " << ours[i] << ", stated " << stated[i]
            << ", tolerance " << tolerance;
}

double largest_input(const Json& vector) {
    double most = 0;
    for (const auto& [name, value] : vector.at("input").items())
        most = std::max(most, largest(oracle::flatten(value)));
    return most;
}

void check_operator(const Json& v) {
    const double tolerance = v.at("tol_rel").get<double>();
    const oracle::Result result = oracle::apply(v);
    const Json& output = v.at("output");
    ASSERT_EQ(result.quantities.size(), output.size()) << "quantities in the output";
    for (const oracle::Quantity& q : result.quantities) {
        const Numbers stated = oracle::flatten(output.at(q.name));
        const double scale = std::max(largest(stated), largest_input(v));
        expect_close(q.values, stated, tolerance * scale, q.name);
    }
    if (!v.contains("A_old_from_new")) return;
    ASSERT_TRUE(result.old_from_new.has_value()) << "the operator has a matrix in the file";
    Numbers ours;
    for (const auto& row : result.old_from_new->rows)
        ours.insert(ours.end(), row.begin(), row.end());
    const Numbers stated = oracle::flatten(v.at("A_old_from_new"));
    expect_close(ours, stated, tolerance * largest(stated), "A, old from new");
}

void check_chain(const Json& v) {
    const double tolerance = v.at("tol_rel").get<double>();
    const std::vector<oracle::Step> steps = oracle::follow_chain(v);
    ASSERT_FALSE(steps.empty());
    double before = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Numbers stated = oracle::flatten(v.at("steps").at(i).at("Sigma"));
        const double scale = std::max(largest(stated), before);
        expect_close(oracle::flatten(steps[i].sigma), stated, tolerance * scale, steps[i].name);
        before = largest(stated);
    }
    const oracle::Matrix& last = steps.back().sigma;
    const Json& output = v.at("output");
    const Numbers stated = oracle::flatten(output.at("Sigma"));
    expect_close(oracle::flatten(last), stated, tolerance * largest(stated), "Sigma");
    if (!output.contains("Sigma2D")) return;
    const covariance::Sym2<double> image = covariance::preintegrate(last);
    const Numbers stated_image = oracle::flatten(output.at("Sigma2D"));
    expect_close({image.xx, image.xy, image.xy, image.yy}, stated_image,
                 tolerance * largest(stated_image), "Sigma2D");
}

TEST(OracleFile, HoldsVectors) {
    ASSERT_EQ(load().error, "");
    ASSERT_FALSE(load().vectors.empty()) << oracle_path() << " holds no vectors";
}

class Vector : public testing::TestWithParam<std::size_t> {};

TEST_P(Vector, AgreesWithTheOperators) {
    const Json& v = load().vectors.at(GetParam());
    SCOPED_TRACE(v.value("name", "(no name)"));
    try {
        if (v.at("op") == "chain") {
            check_chain(v);
        } else {
            check_operator(v);
        }
    } catch (const std::exception& e) {
        FAIL() << e.what();
    }
}

std::vector<std::size_t> indices() {
    std::vector<std::size_t> all(load().vectors.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return all;
}

/// A test name: letters, digits and underscores of the vector's name, made unique by its place.
std::string test_name(const testing::TestParamInfo<std::size_t>& info) {
    const Json& v = load().vectors.at(info.param);
    std::string name = v.is_object() ? v.value("name", "unnamed") : "unnamed";
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name + "_" + std::to_string(info.param);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Vector);
INSTANTIATE_TEST_SUITE_P(File, Vector, testing::ValuesIn(indices()), test_name);

}  // namespace
