/* Bounds of the distance between two convex sets. */
#ifndef CONVEX_DISTANCE_H
#define CONVEX_DISTANCE_H

#include "motion_bound.h"
#include "simplex.h"

/* The difference of the bounds of a distance at which it is known [m]. */
static const double CONVERGED = 1e-7;
enum { MOST_ITERATIONS = 48 };

typedef struct {
    double ahead; /* the lower bound less the motion along its direction [m] */
    double least, most;
} Bounds;

static void support_of_cylinder(const Tree *tree, uint32_t c, const double *direction,
                                double *out) {
    const double *centre = tree->points[tree->convexes[c][0]];
    double axis[3], across[3];
    subtract(tree->points[tree->convexes[c][0] + 1], centre, axis);
    double along = dot(axis, direction);
    for (int i = 0; i < 3; ++i) across[i] = direction[i] - along * axis[i];
    double half = along >= 0.0 ? tree->sizes[c][2] : -tree->sizes[c][2];
    double size = length_of(across), wide = size > 1e-14 ? tree->sizes[c][1] / size : 0.0;
    for (int i = 0; i < 3; ++i) out[i] = centre[i] + half * axis[i] + wide * across[i];
}

/* The point of a convex set that is farthest along a direction, without its rounding.

   On a polytope the search climbs along the edges, from where the last one ended. */
static inline void support(const Tree *tree, uint32_t c, const double *direction, double *out) {
    const uint32_t *set = tree->convexes[c];
    const double (*points)[3] = tree->points;
    if (set[2] == CYLINDER) {
        support_of_cylinder(tree, c, direction, out);
        return;
    }
    uint32_t best = set[2] == POINTS ? set[0] : tree->hints[c];
    double most = dot(points[best], direction);
    if (set[2] == POINTS) {
        for (uint32_t i = set[0] + 1; i < set[1]; ++i) {
            double along = dot(points[i], direction);
            if (along > most) best = i, most = along;
        }
    } else {
        for (int rises = 1; rises;) {
            rises = 0;
            uint32_t k = tree->edges_at[best], end = tree->edges_at[best + 1];
            for (; k < end; ++k) {
                double along = dot(points[tree->edges[k]], direction);
                if (along > most) best = tree->edges[k], most = along, rises = 1;
            }
        }
        tree->hints[c] = best;
    }
    copy(points[best], out, 3);
}

/* The distance of a convex set, placed at T, from a half space. */
static Bounds distance_from_half_space(const Tree *tree, const Tree *other, uint32_t a, uint32_t b,
                                       const double *T, const PairMotion *motion) {
    const double *surface = other->points[other->convexes[b][0]];
    double down[3], direction[3], point[3], placed[3];
    subtract(surface, other->points[other->convexes[b][0] + 1], down);
    rotate_back(T, down, direction);
    support(tree, a, direction, point);
    apply(T, point, placed);
    subtract(placed, surface, placed);
    double exact = -dot(placed, down) - tree->sizes[a][0];
    return (Bounds){exact - (motion ? motion_along(motion, down) : 0.0), exact, exact};
}

/* Bounds of the distance between two convex sets, the first placed at T in the second's frame.

   The Gilbert-Johnson-Keerthi algorithm [1]. Each support point along an axis gives a separating
   plane and so a lower bound that does not depend on how well the search has converged; every point
   of the difference gives an upper bound. The search ends when the lower bound exceeds `free` and
   the motion along the axis, or `free` alone where the interval cannot be certified, or when the
   upper bound is below `blocked`. A negative upper bound is minus a depth by which the sets overlap
   at least.

   `motion` is null where only one state is checked. `axis` is the direction from the second set to
   the first to start with; the best one is kept in it.

   [1] E. Gilbert, D. Johnson, S. Keerthi, "A Fast Procedure for Computing the Distance Between
       Complex Objects in Three-Dimensional Space", IEEE J-RA 4(2), 1988. */
static Bounds distance_bounds(const Tree *tree, const Tree *other, uint32_t a, uint32_t b,
                              const double *T, const PairMotion *motion, double free,
                              double blocked, double *axis) {
    if (other->convexes[b][2] == HALF_SPACE)
        return distance_from_half_space(tree, other, a, b, T, motion);
    double S[4][3], direction[3], rounding = tree->sizes[a][0] + other->sizes[b][0];
    Nearest near;
    Bounds bounds = {-INFINITY, -INFINITY, INFINITY};
    int count = 0;
    copy(axis, direction, 3);
    for (int iteration = 0; iteration < MOST_ITERATIONS; ++iteration) {
        double size = length_of(direction), toward[3], point[3], difference[3];
        rotate_back(T, direction, toward);
        for (int i = 0; i < 3; ++i) toward[i] = -toward[i];
        support(tree, a, toward, point);
        apply(T, point, difference);
        support(other, b, direction, point);
        subtract(difference, point, difference);
        for (int i = 0; i < 3; ++i) direction[i] /= size;
        double bound = dot(direction, difference) - rounding;
        double moved = motion ? motion_along(motion, direction) : 0.0;
        if (bound > bounds.least) {
            bounds.least = bound;
            copy(direction, axis, 3);
        }
        bounds.ahead = largest_of(bounds.ahead, bound - moved);
        bounds.most = least_of(bounds.most, length_of(difference) - rounding);
        if (bounds.ahead > free || bounds.most < blocked ||
            bounds.most - bounds.least < CONVERGED)
            break;
        if (bounds.least > free && bounds.most - moved <= free) break;
        double inside;
        copy(difference, S[count], 3);
        count = reduce_simplex(S, count + 1, &near, &inside);
        if (count == 4) {
            bounds.most = -inside - rounding;
            break;
        }
        copy(near.point, direction, 3);
        size = length_of(direction);
        bounds.most = least_of(bounds.most, size - rounding);
        /* Touching or overlapping: the origin is on the simplex. */
        if (bounds.most < blocked || size < 1e-12) break;
    }
    return bounds;
}

#endif
