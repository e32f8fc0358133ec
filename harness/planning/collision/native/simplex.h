/* The point of a simplex that is nearest to the origin. */
#ifndef SIMPLEX_H
#define SIMPLEX_H

#include <string.h>

#include "arrays.h"

/* A point, and the weights of the corners whose mean it is. */
typedef struct {
    double point[3], weights[3];
} Nearest;

/* The point of a segment nearest to the origin; returns its squared distance. */
static double nearest_on_segment(const double *a, const double *b, Nearest *out) {
    double edge[3], t = 0.0;
    subtract(b, a, edge);
    double square = dot(edge, edge);
    if (square > 0.0) t = clamped(-dot(a, edge) / square, 0.0, 1.0);
    for (int i = 0; i < 3; ++i) out->point[i] = a[i] + t * edge[i];
    out->weights[0] = 1.0 - t;
    out->weights[1] = t;
    out->weights[2] = 0.0;
    return dot(out->point, out->point);
}

/* The point of a triangle nearest to the origin; returns its squared distance. */
static double nearest_on_triangle(const double *a, const double *b, const double *c, Nearest *out) {
    double u[3], v[3], n[3];
    subtract(b, a, u);
    subtract(c, a, v);
    cross(u, v, n);
    double square = dot(n, n);
    if (square > 1e-24 * dot(u, u) * dot(v, v)) {
        double away = dot(a, n) / square, p[3], r[3];
        for (int i = 0; i < 3; ++i) p[i] = away * n[i] - a[i];
        cross(p, v, r);
        double second = dot(r, n) / square;
        cross(u, p, r);
        double third = dot(r, n) / square;
        if (second >= 0.0 && third >= 0.0 && second + third <= 1.0) {
            for (int i = 0; i < 3; ++i) out->point[i] = away * n[i];
            out->weights[0] = 1.0 - second - third;
            out->weights[1] = second;
            out->weights[2] = third;
            return away * away * square;
        }
    }
    Nearest other;
    double best = nearest_on_segment(a, b, out);
    square = nearest_on_segment(a, c, &other);
    if (square < best) {
        best = square;
        *out = (Nearest){{other.point[0], other.point[1], other.point[2]},
                         {other.weights[0], 0.0, other.weights[1]}};
    }
    square = nearest_on_segment(b, c, &other);
    if (square < best) {
        best = square;
        *out = (Nearest){{other.point[0], other.point[1], other.point[2]},
                         {0.0, other.weights[0], other.weights[1]}};
    }
    return best;
}

/* The nearest point of the faces of a tetrahedron that do not hide the origin.

   Writes the corners of that face. Returns how deep the origin is inside, or a number that is not
   positive where it is not. */
static double nearest_on_tetrahedron(const double (*S)[3], Nearest *near, int *corners) {
    double best = INFINITY, inside = INFINITY;
    for (int i = 0; i < 4; ++i) {
        int j = (i + 1) % 4, k = (i + 2) % 4, o = (i + 3) % 4;
        double u[3], v[3], n[3], other[3];
        subtract(S[j], S[i], u);
        subtract(S[k], S[i], v);
        subtract(S[o], S[i], other);
        cross(u, v, n);
        double size = length_of(n), here = dot(n, S[i]), there = dot(n, other);
        double depth = there > 0.0 ? -here : here;
        depth = size > 0.0 && there != 0.0 ? depth / size : -1.0;
        inside = least_of(inside, depth);
        if (depth > 0.0) continue;
        Nearest trial;
        double square = nearest_on_triangle(S[i], S[j], S[k], &trial);
        if (square < best) {
            best = square;
            *near = trial;
            corners[0] = i, corners[1] = j, corners[2] = k;
        }
    }
    return inside;
}

/* Keep the corners of a simplex that span its point nearest to the origin.

   Returns the number of corners that are kept, first in S; of a tetrahedron about the origin all,
   and `inside` is the origin's distance from its nearest face then. */
static int reduce_simplex(double (*S)[3], int count, Nearest *near, double *inside) {
    int corners[3] = {0, 1, 2}, kept = 0;
    *inside = -1.0;
    if (count == 1) {
        copy(S[0], near->point, 3);
        return 1;
    }
    if (count == 2)
        nearest_on_segment(S[0], S[1], near);
    else if (count == 3)
        nearest_on_triangle(S[0], S[1], S[2], near);
    else {
        *inside = nearest_on_tetrahedron((const double (*)[3])S, near, corners);
        if (*inside > 0.0) return 4;
    }
    double spanning[3][3];
    for (int place = 0; place < (count < 3 ? count : 3); ++place)
        if (near->weights[place] > 0.0) copy(S[corners[place]], spanning[kept++], 3);
    memcpy(S, spanning, (size_t)kept * sizeof *spanning);
    return kept;
}

#endif
