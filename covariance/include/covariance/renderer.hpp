// Everything that a path tracer needs beside the operators: the search for occluders, covariances
// of a whole image, filters and their limits, the gather, counts of samples. In contrast to
// covariance.hpp these allocate (std::vector); they throw nothing but std::bad_alloc.
// covariance/README.md, "Ten minutes", has the order of the calls; examples/path_tracer.cpp is a
// whole program.
#pragma once

#include "covariance/budget.hpp"
#include "covariance/covariance.hpp"
#include "covariance/covariance_image.hpp"
#include "covariance/film.hpp"
#include "covariance/filter_field.hpp"
#include "covariance/gather.hpp"
#include "covariance/occluder_grid.hpp"
#include "covariance/path.hpp"
#include "covariance/travel_past.hpp"
