#include <cmath>
#include <optional>

#include "geometry/placed_scene.h"

namespace covtrace {

namespace {

float finite(double v) {
    return std::abs(v) < 1e30 ? static_cast<float>(v) : 0.0f;  // no NaN is below anything
}

}  // namespace

DifferentialGeometry Geometry::differential(const SurfaceHit& hit) const {
    return differential(hit, Frame::from_z_x(hit.ns, hit.tangent));
}

DifferentialGeometry Geometry::differential(const SurfaceHit& hit, const Frame& tangent) const {
    DifferentialGeometry out;
    out.tangent = tangent;
    const Vec3d t1(out.tangent.x), t2(out.tangent.y);

    const EmbreeInstance* instance = nullptr;
    std::optional<Affine> map;
    Vec3d near(hit.position);
    if (hit.instance > 0) {
        instance = &impl_->instances[hit.instance - 1];
        map = impl_->world_from_local(*instance, hit.time);
        near = map->inverse().point(near);
    }
    SurfaceDerivatives d =
        surface_derivatives(impl_->local[hit.shape], hit.primitive, hit.barycentric, near);
    if (instance) {
        d.dpda = map->vector(d.dpda);
        d.dpdb = map->vector(d.dpdb);
        d.n = map->normal(d.n);
        d.dnda = map->normal(d.dnda);
        d.dndb = map->normal(d.dndb);
    }

    // The shape operator is N P^-1, from displacements in the tangent plane, dq = P (da, db), and
    // the change of the unit normal that goes with them, dn = N (da, db).
    const double p11 = dot(d.dpda, t1), p21 = dot(d.dpda, t2), p12 = dot(d.dpdb, t1),
                 p22 = dot(d.dpdb, t2);
    const double determinant = p11 * p22 - p12 * p21;
    const double inverse = 1 / determinant;
    const double i11 = p22 * inverse, i12 = -p12 * inverse;
    const double i21 = -p21 * inverse, i22 = p11 * inverse;

    if (!d.is_flat) {
        const Vec3d ns(out.tangent.z);
        const double scale = (dot(d.n, ns) < 0 ? -1 : 1) / length(d.n);
        const Vec3d na = d.dnda * scale, nb = d.dndb * scale;
        const double n11 = dot(na, t1), n21 = dot(na, t2), n12 = dot(nb, t1), n22 = dot(nb, t2);
        out.k11 = finite(n11 * i11 + n12 * i21);
        out.k22 = finite(n21 * i12 + n22 * i22);
        // The operator is made symmetric: interpolated normals need not be those of a surface, and
        // the closest one has the symmetric part.
        out.k12 = finite(0.5 * (n11 * i12 + n12 * i22 + n21 * i11 + n22 * i21));
    }

    out.uv_from_tangent[0][0] = finite(d.duvda.x * i11 + d.duvdb.x * i21);
    out.uv_from_tangent[0][1] = finite(d.duvda.x * i12 + d.duvdb.x * i22);
    out.uv_from_tangent[1][0] = finite(d.duvda.y * i11 + d.duvdb.y * i21);
    out.uv_from_tangent[1][1] = finite(d.duvda.y * i12 + d.duvdb.y * i22);

    if (instance && instance->moves) {
        const Affine rate = instance->motion.rate(hit.time, impl_->clock);
        out.velocity = rate.point(near).to_float();
        // The angular velocity is half the curl of the velocity field x -> rate(map^-1(x)).
        const Affine local = map->inverse();
        Vec3d gradient[3];
        for (int i = 0; i < 3; ++i) gradient[i] = local.transposed(rate.row[i]);
        const Vec3d curl{gradient[2].y - gradient[1].z, gradient[0].z - gradient[2].x,
                         gradient[1].x - gradient[0].y};
        out.angular_velocity = (curl * 0.5).to_float();
    }
    return out;
}

}  // namespace covtrace
