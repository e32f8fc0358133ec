/* The arrays that Python passes to the check of motions, and small vector operations. */
#ifndef ARRAYS_H
#define ARRAYS_H

#include <math.h>
#include <stdint.h>

/* A C-contiguous array: its first item, and its shape filled up with ones. */
typedef struct {
    void *data;
    int64_t shape[3];
} Array;

/* What each array of the table is; certificates.py enters them in this order. */
enum {
    CORNERS, PLACES, QUEUE, FOUND, PARENT, CHAIN, BODY_POSES, BODIES, BOXES, BALLS,
    LINKS, /* the eight arrays of a Tree */
    OBJECTS = LINKS + 8,
    MARGINS = OBJECTS + 8,
    CHECKS, PATHS, JOINTS, HERE, RATES, POSES, BODY_AT, MIDDLES, MOTIONS, AXES, BODY_STAMP, LEFT
};

/* The kinds of convex sets, as in convex_kinds.py. */
enum { POINTS, POLYTOPE, CYLINDER, HALF_SPACE };

/* The arrays of a ConvexTree (convex_tree.py), and a point of each set to begin a search with. */
typedef struct {
    const double (*spheres)[4];
    const int64_t (*nodes)[2];
    const uint32_t (*convexes)[3];
    const double (*sizes)[3];
    const double (*points)[3];
    const uint32_t *edges_at, *edges;
    uint32_t *hints;
} Tree;

/* A transform is a rotation row by row, then a translation. */
typedef double Transform[12];

static inline double least_of(double a, double b) { return a < b ? a : b; }
static inline double largest_of(double a, double b) { return a > b ? a : b; }
static inline double clamped(double x, double low, double high) {
    return least_of(largest_of(x, low), high);
}
static inline double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline double length_of(const double *a) { return sqrt(dot(a, a)); }
static inline void subtract(const double *a, const double *b, double *out) {
    for (int i = 0; i < 3; ++i) out[i] = a[i] - b[i];
}
static inline void cross(const double *a, const double *b, double *out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}
static inline void copy(const double *from, double *to, int count) {
    for (int i = 0; i < count; ++i) to[i] = from[i];
}

/* The rotation of a transform, and its transpose, times a vector. */
static inline void rotate(const double *T, const double *v, double *out) {
    for (int i = 0; i < 3; ++i) out[i] = dot(T + 3 * i, v);
}
static inline void rotate_back(const double *T, const double *v, double *out) {
    for (int i = 0; i < 3; ++i) out[i] = T[i] * v[0] + T[3 + i] * v[1] + T[6 + i] * v[2];
}
static inline void apply(const double *T, const double *point, double *out) {
    for (int i = 0; i < 3; ++i) out[i] = dot(T + 3 * i, point) + T[9 + i];
}

/* The product of two transforms. */
static inline void compose(const double *first, const double *second, double *out) {
    for (int i = 0; i < 3; ++i) {
        double a = first[3 * i], b = first[3 * i + 1], c = first[3 * i + 2];
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] = a * second[j] + b * second[3 + j] + c * second[6 + j];
        out[9 + i] = a * second[9] + b * second[10] + c * second[11] + first[9 + i];
    }
}

/* The transform of `other` relative to `base`. */
static inline void relative_transform(const double *base, const double *other, double *out) {
    double step[3];
    subtract(other + 9, base + 9, step);
    for (int i = 0; i < 3; ++i) {
        double a = base[i], b = base[3 + i], c = base[6 + i];
        for (int j = 0; j < 3; ++j)
            out[3 * i + j] = a * other[j] + b * other[3 + j] + c * other[6 + j];
        out[9 + i] = a * step[0] + b * step[1] + c * step[2];
    }
}

#endif
