// The map from operations named in a file of test vectors to the operators of the library.
#pragma once

#include <covariance/covariance.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace oracle {

using Json = nlohmann::json;
using Numbers = std::vector<double>;
using Matrix = covariance::SymmetricMatrix5<double>;

/// One quantity that an operator produced, under the name it has in the file ("Sigma", "Q", "N",
/// ...), with its entries row by row.
struct Quantity {
    std::string name;
    Numbers values;
};

struct Result {
    std::vector<Quantity> quantities;
    /// The operator's own matrix, old from new coordinates, where it is a change of coordinates.
    std::optional<covariance::Matrix5<double>> old_from_new;
};

/// One step of a chain: its name in the file, and the covariance after it.
struct Step {
    std::string name;
    Matrix sigma;
};

/// All numbers of a nested array, row by row; throws where it holds something else.
Numbers flatten(const Json& array);
Numbers flatten(const Matrix& s);

/// Applies the operation `vector["op"]`; throws std::invalid_argument where it is not known.
Result apply(const Json& vector);

/// Follows the path of a vector whose op is "chain", step by step as named in `vector["steps"]`,
/// each from the library's own result of the one before; throws where a step is not known.
std::vector<Step> follow_chain(const Json& vector);

}  // namespace oracle
