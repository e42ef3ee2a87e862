/// Vectorisation: makes a function of single matrices, vectors and numbers into one of numpy
/// arrays. Every argument may have leading dimensions, and these are broadcast against each other
/// as numpy does.
#pragma once

#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <covariance/covariance.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "python_lock.h"

namespace covtrace::python {

namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Layout of one argument in the last dimensions of an array: its shape, loading and storing.
template <typename T>
struct Item;

template <>
struct Item<double> {
    static constexpr std::array<py::ssize_t, 0> shape{};
    static double load(const double* p) { return *p; }
    static void store(double v, double* p) { *p = v; }
};

/// Symmetric matrices are read from both triangles, whose mean counts.
template <>
struct Item<covariance::SymmetricMatrix5<double>> {
    static constexpr std::array<py::ssize_t, 2> shape{5, 5};
    static covariance::SymmetricMatrix5<double> load(const double* p) {
        covariance::SymmetricMatrix5<double> s;
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = i; j < 5; ++j) s(i, j) = (p[5 * i + j] + p[5 * j + i]) / 2;
        return s;
    }
    static void store(const covariance::SymmetricMatrix5<double>& s, double* p) {
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = 0; j < 5; ++j) p[5 * i + j] = s(i, j);
    }
};

template <>
struct Item<covariance::Matrix5<double>> {
    static constexpr std::array<py::ssize_t, 2> shape{5, 5};
    static covariance::Matrix5<double> load(const double* p) {
        covariance::Matrix5<double> a;
        for (size_t i = 0; i < 5; ++i)
            for (size_t j = 0; j < 5; ++j) a(i, j) = p[5 * i + j];
        return a;
    }
};

template <>
struct Item<covariance::Sym2<double>> {
    static constexpr std::array<py::ssize_t, 2> shape{2, 2};
    static covariance::Sym2<double> load(const double* p) {
        return {p[0], (p[1] + p[2]) / 2, p[3]};
    }
    static void store(const covariance::Sym2<double>& s, double* p) {
        p[0] = s.xx, p[1] = p[2] = s.xy, p[3] = s.yy;
    }
};

template <>
struct Item<covariance::Mat2<double>> {
    static constexpr std::array<py::ssize_t, 2> shape{2, 2};
    static covariance::Mat2<double> load(const double* p) { return {p[0], p[1], p[2], p[3]}; }
};

template <>
struct Item<covariance::Vec3<double>> {
    static constexpr std::array<py::ssize_t, 1> shape{3};
    static covariance::Vec3<double> load(const double* p) { return {p[0], p[1], p[2]}; }
    static void store(const covariance::Vec3<double>& v, double* p) {
        p[0] = v.x, p[1] = v.y, p[2] = v.z;
    }
};

/// Frames are the rows X, Y, Z.
template <>
struct Item<covariance::Frame<double>> {
    using Row = Item<covariance::Vec3<double>>;
    static constexpr std::array<py::ssize_t, 2> shape{3, 3};
    static covariance::Frame<double> load(const double* p) {
        return {Row::load(p), Row::load(p + 3), Row::load(p + 6)};
    }
    static void store(const covariance::Frame<double>& f, double* p) {
        Row::store(f.x, p), Row::store(f.y, p + 3), Row::store(f.z, p + 6);
    }
};

/// The leading dimensions of an array whose last ones are an item's; `operand` is its index among
/// the arguments, for the message.
template <typename T>
std::vector<py::ssize_t> leading_shape(const Array& a, size_t operand) {
    constexpr auto& item = Item<T>::shape;
    const auto rank = static_cast<py::ssize_t>(item.size());
    bool fits = a.ndim() >= rank;
    for (py::ssize_t k = 0; fits && k < rank; ++k)
        fits = a.shape(a.ndim() - rank + k) == item[static_cast<size_t>(k)];
    if (!fits) {
        std::string expected = "(...";
        for (const py::ssize_t n : item) expected += ", " + std::to_string(n);
        throw py::value_error("argument " + std::to_string(operand + 1) + " has the shape " +
                              std::string(py::str(a.attr("shape"))) + "; expected " + expected +
                              ")");
    }
    return {a.shape(), a.shape() + (a.ndim() - rank)};
}

/// Widens `shape` to hold `other`, too.
inline void broadcast(std::vector<py::ssize_t>& shape, const std::vector<py::ssize_t>& other) {
    if (other.size() > shape.size()) shape.insert(shape.begin(), other.size() - shape.size(), 1);
    const size_t skip = shape.size() - other.size();
    for (size_t k = 0; k < other.size(); ++k) {
        py::ssize_t& n = shape[skip + k];
        if (n == 1) n = other[k];
        if (other[k] != 1 && other[k] != n)
            throw py::value_error("the leading dimensions of the arguments don't match");
    }
}

/// Walks through the items of one array as if it had the common leading shape.
class Cursor {
  public:
    Cursor(const Array& a, const std::vector<py::ssize_t>& own,
           const std::vector<py::ssize_t>& common, py::ssize_t item_size)
        : data_(a.data()), steps_(common.size(), 0) {
        py::ssize_t step = item_size;
        for (size_t k = own.size(); k-- > 0;) {
            if (own[k] != 1) steps_[common.size() - own.size() + k] = step;
            step *= own[k];
        }
    }
    const double* at(const std::vector<py::ssize_t>& index) const {
        py::ssize_t offset = 0;
        for (size_t k = 0; k < index.size(); ++k) offset += index[k] * steps_[k];
        return data_ + offset;
    }

  private:
    const double* data_;
    std::vector<py::ssize_t> steps_;
};

template <typename T>
constexpr py::ssize_t item_size() {
    py::ssize_t size = 1;
    for (const py::ssize_t n : Item<T>::shape) size *= n;
    return size;
}

/// The result: one array, or one for each member of a pair (matrix, frame).
template <typename T>
struct Result {
    py::array_t<double> array;
    explicit Result(std::vector<py::ssize_t> shape)
        : array([&] {
              shape.insert(shape.end(), Item<T>::shape.begin(), Item<T>::shape.end());
              return py::array_t<double>(shape);
          }()),
          next(array.mutable_data()) {}
    double* next;
    void put(const T& value) {
        Item<T>::store(value, next);
        next += item_size<T>();
    }
    py::object take() { return std::move(array); }
};
template <>
struct Result<covariance::LightField<double>> {
    Result<covariance::SymmetricMatrix5<double>> sigma;
    Result<covariance::Frame<double>> frame;
    explicit Result(const std::vector<py::ssize_t>& shape) : sigma(shape), frame(shape) {}
    void put(const covariance::LightField<double>& field) {
        sigma.put(field.sigma);
        frame.put(field.frame);
    }
    py::object take() { return py::make_tuple(sigma.take(), frame.take()); }
};

template <typename>
using ArrayFor = Array;

/// Makes the function of arrays. Results have the common leading shape and then the item's; a
/// LightField comes back as the tuple (sigma, frame).
template <typename R, typename... Arguments>
auto vectorized(R (*function)(Arguments...)) {
    return [function](const ArrayFor<Arguments>&... arrays) -> py::object {
        return [&]<size_t... I>(std::index_sequence<I...>)->py::object {
            using Items = std::tuple<std::decay_t<Arguments>...>;
            const std::array<std::vector<py::ssize_t>, sizeof...(I)> own{
                leading_shape<std::tuple_element_t<I, Items>>(arrays, I)...};
            std::vector<py::ssize_t> shape;
            for (const auto& s : own) broadcast(shape, s);
            const std::array<Cursor, sizeof...(I)> cursors{
                Cursor(arrays, own[I], shape, item_size<std::tuple_element_t<I, Items>>())...};
            py::ssize_t count = 1;
            for (const py::ssize_t n : shape) count *= n;
            Result<R> result(shape);
            {
                const Unlocked unlocked;
                std::vector<py::ssize_t> index(shape.size(), 0);
                for (py::ssize_t i = 0; i < count; ++i) {
                    result.put(function(
                        Item<std::tuple_element_t<I, Items>>::load(cursors[I].at(index))...));
                    for (size_t k = index.size(); k-- > 0;) {
                        if (++index[k] < shape[k]) break;
                        index[k] = 0;
                    }
                }
            }
            py::object taken = result.take();
            // Without leading dimensions and item dimensions the result is a number.
            if (shape.empty() && py::isinstance<py::array>(taken) &&
                taken.attr("ndim").cast<int>() == 0)
                return taken.attr("item")();
            return taken;
        }
        (std::index_sequence_for<Arguments...>{});
    };
}

}  // namespace covtrace::python
