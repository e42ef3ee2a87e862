// The whole library: second moments of the spectrum of the light around a ray, followed from the
// light to the sensor. Headers only, standard library only; nothing here allocates, throws or
// prints, and everything works in float and double. The mathematics is explained in
// covariance/README.md.
#pragma once

#include "covariance/aligned.hpp"
#include "covariance/angular.hpp"
#include "covariance/average.hpp"
#include "covariance/brdf.hpp"
#include "covariance/diffuse.hpp"
#include "covariance/filter.hpp"
#include "covariance/frame.hpp"
#include "covariance/lens.hpp"
#include "covariance/light_field.hpp"
#include "covariance/matrix5.hpp"
#include "covariance/motion.hpp"
#include "covariance/occlusion.hpp"
#include "covariance/preintegrate.hpp"
#include "covariance/reflection.hpp"
#include "covariance/refraction.hpp"
#include "covariance/rotate.hpp"
#include "covariance/sampling.hpp"
#include "covariance/scalar.hpp"
#include "covariance/source.hpp"
#include "covariance/surface.hpp"
#include "covariance/sym2.hpp"
#include "covariance/symmetric.hpp"
#include "covariance/texture.hpp"
#include "covariance/travel.hpp"
#include "covariance/vec3.hpp"
