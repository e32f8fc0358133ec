/* Conservative advancement of a motion with exact convex distances.

   Compiled when the package is built (build.py) and called through ctypes (library.py). It allocates
   no memory: the arrays belong to `MotionArrays` of certificates.py, which documents them. */

#include <stddef.h>

#include "tree_distance.h"

/* The memory for intervals is full. */
#define FULL (-((int64_t)1 << 62))

/* The number of states up to which a stretch is left undecided as a whole, where all pairs that are
   not certified may be in contact: how deep they are is not measured here. */
enum { CONTACT_STATES = 64 };

/* The states from `low` to `high`; the pairs that are not certified yet are left[begin] to
   left[end - 1]. */
typedef struct {
    int64_t low, high, begin, end;
} Interval;

typedef struct {
    const double *corners, *places; /* (corner_count, width), (corner_count) */
    int64_t corner_count, width;
    const int64_t *parent;
    const Joint *chain;
    const Transform *body_poses;
    const int64_t (*bodies)[3]; /* joint or -1, root, 1 if it is in the tree of objects */
    const double (*boxes)[6], (*balls)[4], (*margins)[2];
    const uint32_t (*checks)[4], *paths, *joints;
    Tree trees[2]; /* of the links, and of the objects */
    /* Working memory. */
    double *here, *rates, *strays;
    Transform *poses, *body_at;
    double (*middles)[3];
    BodyMotion *motions; /* (bodies, joints that carry a body + 1) */
    int64_t motion_rows;
    double (*axes)[3];
    int64_t *body_stamp;
    uint32_t *left;
} Check;

static Tree tree_at(const Array *table) {
    return (Tree){table[0].data, table[1].data, table[2].data, table[3].data,
                  table[4].data, table[5].data, table[6].data, table[7].data};
}

static Check check_of(const Array *t) {
    return (Check){
        .corners = t[CORNERS].data, .places = t[PLACES].data,
        .corner_count = t[CORNERS].shape[0], .width = t[CORNERS].shape[1],
        .parent = t[PARENT].data, .chain = t[CHAIN].data, .body_poses = t[BODY_POSES].data,
        .bodies = t[BODIES].data, .boxes = t[BOXES].data, .balls = t[BALLS].data,
        .margins = t[MARGINS].data, .checks = t[CHECKS].data, .paths = t[PATHS].data,
        .joints = t[JOINTS].data, .trees = {tree_at(t + LINKS), tree_at(t + OBJECTS)},
        .here = t[HERE].data, .rates = t[RATES].data, .poses = t[POSES].data,
        .strays = (double *)t[RATES].data + t[CORNERS].shape[1],
        .body_at = t[BODY_AT].data, .middles = t[MIDDLES].data, .motions = t[MOTIONS].data,
        .motion_rows = t[MOTIONS].shape[1], .axes = t[AXES].data,
        .body_stamp = t[BODY_STAMP].data, .left = t[LEFT].data,
    };
}

/* The number of the segment of the polyline that contains a state. */
static int64_t segment_of(const Check *c, int64_t state) {
    int64_t low = 0, high = c->corner_count - 2;
    while (low < high) {
        int64_t middle = (low + high + 1) / 2;
        if (c->places[middle] <= (double)state)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* A joint's value at a state of a segment. */
static double joint_at(const Check *c, int64_t joint, int64_t segment, double state) {
    const double *at = c->corners + segment * c->width + joint, *begin = c->places + segment;
    return *at + (at[c->width] - *at) / (begin[1] - *begin) * (state - *begin);
}

/* Write the joints' values at an interval's middle state, how far they move to its end at the even
   rate that joins its ends, and how far they stray from that at most: at an end or at a corner. */
static void sample_joints(const Check *c, int64_t low, int64_t high) {
    int64_t first = segment_of(c, low), final = segment_of(c, high), middle = (low + high) / 2;
    int64_t k = segment_of(c, middle);
    for (int64_t m = 0; m < c->width; ++m) {
        double here = joint_at(c, m, k, (double)middle), begin = joint_at(c, m, first, (double)low);
        double way = joint_at(c, m, final, (double)high) - begin, stray = 0.0;
        double rate = high > low ? way / (double)(high - low) : 0.0;
        if (final > first) stray = fabs(begin - here + rate * (double)(middle - low));
        for (int64_t corner = first + 1; corner <= final; ++corner) {
            double away = c->corners[corner * c->width + m] - here;
            stray = largest_of(stray, fabs(away - rate * (c->places[corner] - (double)middle)));
        }
        c->here[m] = here;
        c->rates[m] = rate * (double)(high - middle);
        c->strays[m] = stray;
    }
}

/* Place a body at the interval's middle state, and bound its motion where there is one. */
static void place_body(const Check *c, uint32_t body, int moves) {
    int64_t joint = c->bodies[body][0];
    if (joint >= 0)
        compose(c->poses[joint], c->body_poses[body], c->body_at[body]);
    else
        copy(c->body_poses[body], c->body_at[body], 12);
    apply(c->body_at[body], c->balls[body], c->middles[body]);
    if (moves)
        body_motion(c->rates, c->strays, c->joints + c->paths[body], c->joints + c->paths[body + 1], c->chain,
                    (const Transform *)c->poses, c->middles[body], c->balls[body][3],
                    c->motions + body * c->motion_rows);
}

/* The distance of a point from a body's box, and the direction from the box to it in the world. */
static double box_gap(const double *point, const double *base, const double *box,
                      double *direction) {
    double step[3], local[3];
    subtract(point, base + 9, step);
    rotate_back(base, step, local);
    for (int i = 0; i < 3; ++i) local[i] -= clamped(local[i], box[i], box[3 + i]);
    double gap = length_of(local);
    if (gap > 0.0) {
        for (int i = 0; i < 3; ++i) local[i] /= gap;
        rotate(base, local, direction);
    }
    return gap;
}

/* Whether a pair keeps its distance over an interval, and at its middle state (tree_distance.h).

   The balls of the bodies are compared first, then the ball of each with the box of the other, and
   then their trees. */
static int compare_bodies(const Check *c, uint32_t pair, int moves) {
    const uint32_t *row = c->checks[pair];
    uint32_t ends[2] = {row[0], row[1]};
    double free = c->margins[pair][0], blocked = c->margins[pair][1], moved = 0.0;
    const BodyMotion *near = c->motions + ends[0] * c->motion_rows + row[2];
    const BodyMotion *far = c->motions + ends[1] * c->motion_rows + row[3];
    if (moves) moved = near->all + far->all;
    double step[3], least = c->balls[ends[0]][3] + c->balls[ends[1]][3] + free + moved;
    subtract(c->middles[ends[0]], c->middles[ends[1]], step);
    if (dot(step, step) > least * least) return FREE;

    double directions[2][3], excess[2];
    for (int side = 0; side < 2; ++side) {
        uint32_t ball = ends[side], body = ends[1 - side];
        double radius = c->balls[ball][3];
        double gap = box_gap(c->middles[ball], c->body_at[body], c->boxes[body], directions[side]);
        excess[side] = gap - radius - free;
        if (excess[side] <= 0.0) continue;
        if (excess[side] > moved) return FREE;
        if (moved > gap + radius) return CLEAR_STATE; /* the interval is too long to be certified */
    }
    const double *base = c->body_at[ends[1]];
    PairMotion motion;
    if (moves) {
        pair_motion(near, far, base, &motion);
        for (int side = 0; side < 2; ++side) {
            double local[3];
            if (excess[side] <= 0.0) continue;
            rotate_back(base, directions[side], local);
            if (excess[side] > motion_along(&motion, local)) return FREE;
        }
    }
    Transform relative;
    relative_transform(base, c->body_at[ends[0]], relative);
    return compare_trees(&c->trees[c->bodies[ends[0]][2]], &c->trees[c->bodies[ends[1]][2]],
                         (NodePair){c->bodies[ends[0]][1], c->bodies[ends[1]][1]}, relative, free,
                         blocked, moves ? &motion : NULL, c->axes[pair]);
}

/* Compare a pair before all others from now on: it often blocks the next motion too. */
static void move_to_front(uint32_t *order, uint32_t pair) {
    int64_t place = 0;
    while (order[place] != pair) ++place;
    for (; place > 0; --place) order[place] = order[place - 1];
    order[0] = pair;
}

/* Classify a range of the states of a motion as free, blocked or undecided.

   The last state is checked first, then the whole range, then its halves: an interval is free for a
   pair when the distance at its middle state exceeds the motion bound of the interval.

   Returns the number of undecided stretches, whose first and last states are in the array FOUND;
   -1 - i where the state i is blocked; FULL. */
int64_t certify(const Array *table, int64_t low, int64_t high) {
    Check check = check_of(table);
    const Check *c = &check;
    Interval *queue = table[QUEUE].data;
    int64_t (*found)[2] = table[FOUND].data;
    int64_t total = table[CHECKS].shape[0], room = total, undecided = 0, head = 0, tail = 0;
    for (int64_t body = 0; body < table[BODY_STAMP].shape[0]; ++body) c->body_stamp[body] = -1;
    queue[tail++] = (Interval){high, high, 0, total};
    if (high > low) queue[tail++] = (Interval){low, high - 1, 0, total};
    while (head < tail) {
        Interval interval = queue[head];
        int64_t stamp = head++, middle = (interval.low + interval.high) / 2;
        int moves = interval.high > interval.low;
        sample_joints(c, interval.low, interval.high);
        joint_poses(c->here, c->parent, c->chain, c->width, c->poses);

        /* The pairs that are not certified are listed for the halves, while there is room. */
        int64_t kept = room, failed = 0;
        int has_room = room + (interval.end - interval.begin) <= table[LEFT].shape[0];
        int is_open = 0, is_contact = 1;
        for (int64_t place = interval.begin; place < interval.end; ++place) {
            uint32_t pair = c->left[place];
            for (int side = 0; side < 2; ++side) {
                uint32_t body = c->checks[pair][side];
                if (c->body_stamp[body] == stamp) continue;
                place_body(c, body, moves);
                c->body_stamp[body] = stamp;
            }
            int answer = compare_bodies(c, pair, moves);
            if (answer == FREE) continue;
            if (answer == BLOCKED) {
                move_to_front(c->left, pair);
                return -1 - middle;
            }
            if (has_room) c->left[room + failed] = pair;
            ++failed;
            is_open |= answer == UNDECIDED;
            is_contact &= c->margins[pair][1] == -INFINITY;
        }
        if (failed == 0 || (!moves && !is_open)) continue;
        if (!moves || (is_contact && interval.high - interval.low < CONTACT_STATES)) {
            found[undecided][0] = interval.low;
            found[undecided++][1] = interval.high;
            continue;
        }
        if (is_open) found[undecided][0] = found[undecided][1] = middle, ++undecided;
        if (tail + 2 > table[QUEUE].shape[0]) return FULL;
        Interval half = interval;
        if (has_room) {
            half.begin = kept, half.end = kept + failed;
            room += failed;
        }
        half.low = interval.low, half.high = middle - 1;
        if (middle > interval.low) queue[tail++] = half;
        half.low = middle + 1, half.high = interval.high;
        queue[tail++] = half;
    }
    return undecided;
}
