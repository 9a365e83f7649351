/* One period of a train after the other, with its outputs at equal distances: Radau IIA of order 5 by
   simplified Newton iterations, whose Jacobian stays as long as they converge, with an estimate of order 3
   (Hairer and Wanner, Solving ODEs II, IV.8).

   For hosts without a library, such as a browser: what they set and read are arrays of fixed sizes. */
#include <stdbool.h>
#include <stdint.h>

#include "kernels.h"
#include "sizes.h"

#define N STATES
#define STAGES 3
#define MOST_ITERATIONS 6
/* A step grows or shrinks by no more than this, aims at this share of the error allowed, and keeps its length,
   with the factors, where it could grow by less than KEPT. */
#define LARGEST 8.0
#define SMALLEST 0.2
#define SAFETY 0.9
#define KEPT 1.2
/* An iteration that contracts faster keeps its Jacobian. */
#define CONTRACTING 1e-3
/* Samples that a step may pass. */
#define MOST_SAMPLES 8
/* Changes of a period that are extrapolated: the sum of their squares. */
#define LITTLE 1e-2
/* Of a period, below which a step makes no progress. */
#define HOPELESS 1e-12
/* Of a period, beyond which a page would seem dead; some need 50 000. */
#define MOST_STEPS 500000
/* The root of what a double resolves. */
#define DIFFERENCE 1.5e-8

#define CALL(kernel, ...) kernel_##kernel(&(int64_t){0}, &(void *){0}, __VA_ARGS__)

double parameters[PARAMETERS + 1], inputs[INPUTS + 1], state[N], start[N], nominal[N];
double rows[(SAMPLES + 1) * OUTPUTS];
/* The least and the largest output from each row to the next: of both rows, and of the ends of steps between. */
double lows[SAMPLES * OUTPUTS], highs[SAMPLES * OUTPUTS];
/* By state: whether each period begins it at its start, and whether it must stay above zero. */
int32_t held[N], positive[N];
/* The states at the begin of the last period, and at the end of the one before; what that one changed, over
   nominal + |value|, and how much of it there was. */
static double begun[N], ended[N], shift[N], shifted;

static const double NODES[STAGES] = {0.15505102572168219, 0.6449489742783178, 1.0};
/* Eigenvalues of the inverse of the method's matrix, and the transformation to its real form and back. */
#define REAL 3.6378342527444957
#define PAIR_RE 2.6810828736277523
#define PAIR_IM (-3.0504301992474105)
static const double TO[STAGES][STAGES] = {
    {4.17871859155190428, 0.32768282076106237, 0.52337644549944951},
    {-4.17871859155190428, -0.32768282076106237, 0.47662355450055044},
    {0.50287263494578682, -2.57192694985560522, 0.59603920482822492}};
static const double FROM[STAGES][STAGES] = {
    {0.09443876248897524, -0.14125529502095421, 0.03002919410514742},
    {0.25021312296533332, 0.20412935229379994, -0.38294211275726192},
    {1.0, 1.0, 0.0}};
static const double ESTIMATE[STAGES] = {-10.048809399827416, 1.382142733160749, -1.0 / 3.0};
/* Of the polynomial through a step's stages, by powers of its share from the first on. */
static const double POWERS[STAGES][STAGES] = {
    {10.048809399827416, -1.3821427331607488, 1.0 / 3.0},
    {-25.62959144707664, 10.296258113743304, -8.0 / 3.0},
    {15.58078204724922, -8.914115380582556, 10.0 / 3.0}};

typedef double Stages[STAGES][N];
static double rate[N], next[N], changed[N], error[N], reached[OUTPUTS];
/* Changes of the state to the nodes, their rates, both transformed, and the polynomial of the last step. */
static Stages stage, slope, moved, change, polynomial;
static double jacobian[N][N];
static bool moving[N];

/* Factors of (mu / h) I - J, with an imaginary part. */
static struct Factors {
    double re[N][N], im[N][N];
    int pivot[N];
} single, pair;

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static void find_rate(double t, const double *x, double *dx)
{
    CALL(derivative, t, x, inputs, parameters, dx);
}

static void differentiate(double t, int column)
{
    double kept = next[column], beside = kept + DIFFERENCE * (nominal[column] + magnitude(kept));
    next[column] = beside;
    find_rate(t, next, changed);
    next[column] = kept;
    for (int i = 0; i < N; i++) jacobian[i][column] = (changed[i] - rate[i]) / (beside - kept);
    moving[column] = true;
}

/* Columns of the states that move, and of those that they move. */
static void find_jacobian(double t)
{
    bool more = true;
    for (int i = 0; i < N; i++) {
        next[i] = state[i];
        moving[i] = false;
        for (int j = 0; j < N; j++) jacobian[i][j] = 0.0;
    }
    for (int i = 0; i < N; i++)
        if (rate[i] != 0.0) differentiate(t, i);
    while (more) {
        more = false;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N && !moving[i]; j++)
                if (jacobian[i][j] != 0.0) {
                    differentiate(t, i);
                    more = true;
                }
    }
}

static double weigh(const struct Factors *f, int i, int j)
{
    return magnitude(f->re[i][j]) + magnitude(f->im[i][j]);
}

static void factorise(struct Factors *f, double re, double im)
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            f->re[i][j] = (i == j ? re : 0.0) - jacobian[i][j];
            f->im[i][j] = i == j ? im : 0.0;
        }
    for (int c = 0; c < N; c++) {
        int p = c;
        for (int i = c + 1; i < N; i++)
            if (weigh(f, i, c) > weigh(f, p, c)) p = i;
        f->pivot[c] = p;
        for (int j = 0; j < N && p != c; j++) {
            double a = f->re[c][j], b = f->im[c][j];
            f->re[c][j] = f->re[p][j];
            f->im[c][j] = f->im[p][j];
            f->re[p][j] = a;
            f->im[p][j] = b;
        }
        double a = f->re[c][c], b = f->im[c][c], size = a * a + b * b;
        for (int i = c + 1; i < N; i++) {
            double x = f->re[i][c], y = f->im[i][c];
            if (x == 0.0 && y == 0.0) continue;
            double u = f->re[i][c] = (x * a + y * b) / size, v = f->im[i][c] = (y * a - x * b) / size;
            for (int j = c + 1; j < N; j++) {
                f->re[i][j] -= u * f->re[c][j] - v * f->im[c][j];
                f->im[i][j] -= u * f->im[c][j] + v * f->re[c][j];
            }
        }
    }
}

static void subtract(const struct Factors *f, int i, int j, double *x, double *y)
{
    x[i] -= f->re[i][j] * x[j] - f->im[i][j] * y[j];
    y[i] -= f->re[i][j] * y[j] + f->im[i][j] * x[j];
}

static void solve(const struct Factors *f, double *x, double *y)
{
    for (int c = 0; c < N; c++) {
        int p = f->pivot[c];
        double a = x[p], b = y[p];
        x[p] = x[c];
        y[p] = y[c];
        x[c] = a;
        y[c] = b;
    }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < i; j++) subtract(f, i, j, x, y);
    for (int i = N - 1; i >= 0; i--) {
        for (int j = i + 1; j < N; j++) subtract(f, i, j, x, y);
        double a = f->re[i][i], b = f->im[i][i], size = a * a + b * b, re = x[i];
        x[i] = (re * a + y[i] * b) / size;
        y[i] = (y[i] * a - re * b) / size;
    }
}

static void solve_single(double *x)
{
    double none[N] = {0};
    solve(&single, x, none);
}

static void factorise_both(double h)
{
    factorise(&single, REAL / h, 0.0);
    factorise(&pair, PAIR_RE / h, PAIR_IM / h);
}

static void transform(const double by[STAGES][STAGES], Stages from, Stages to)
{
    for (int s = 0; s < STAGES; s++)
        for (int i = 0; i < N; i++)
            to[s][i] = by[s][0] * from[0][i] + by[s][1] * from[1][i] + by[s][2] * from[2][i];
}

/* Iterates the stages; how often, 0 where it does not converge. `contraction` is theirs. */
static int iterate(double t, double h, double tolerance, double *contraction)
{
    double before = 0.0, root = __builtin_sqrt(*contraction);
    double enough = __builtin_sqrt(tolerance);
    if (enough > 0.03) enough = 0.03;
    *contraction = root * __builtin_sqrt(root);
    transform(TO, stage, moved);
    for (int k = 1; k <= MOST_ITERATIONS; k++) {
        double sum = 0.0;
        for (int s = 0; s < STAGES; s++) {
            for (int i = 0; i < N; i++) next[i] = state[i] + stage[s][i];
            find_rate(t + NODES[s] * h, next, slope[s]);
        }
        transform(TO, slope, change);
        for (int i = 0; i < N; i++) {
            double a = moved[1][i], b = moved[2][i];
            change[0][i] -= REAL * moved[0][i] / h;
            change[1][i] -= (PAIR_RE * a - PAIR_IM * b) / h;
            change[2][i] -= (PAIR_RE * b + PAIR_IM * a) / h;
        }
        solve_single(change[0]);
        solve(&pair, change[1], change[2]);
        for (int s = 0; s < STAGES; s++)
            for (int i = 0; i < N; i++) {
                double share = change[s][i] / (tolerance * (nominal[i] + magnitude(state[i])));
                moved[s][i] += change[s][i];
                sum += share * share;
            }
        transform(FROM, moved, stage);
        double size = __builtin_sqrt(sum / (STAGES * N));
        if (k > 1) {
            double ratio = size / before;
            double left = size / (1.0 - ratio);
            for (int q = k; q < MOST_ITERATIONS; q++) left *= ratio;
            if (!(ratio < 1.0) || left > enough) return 0;
            *contraction = ratio / (1.0 - ratio);
        }
        if (*contraction * size < enough) return k;
        if (!(size < 1e100)) return 0;
        before = size;
    }
    return 0;
}

/* The error of the step to the last stage, of which 1 is allowed; NaN where that is no state. `again` for a
   step after a refused one, whose estimate may be too large. */
static double estimate(double t, double h, double tolerance, bool again)
{
    double sum = 0.0, slopes[N];
    for (int i = 0; i < N; i++) {
        next[i] = state[i] + stage[2][i];
        if (positive[i] && !(next[i] > 0.0)) return __builtin_nan("");
        slopes[i] = (ESTIMATE[0] * stage[0][i] + ESTIMATE[1] * stage[1][i] + ESTIMATE[2] * stage[2][i]) / h;
        error[i] = rate[i] + slopes[i];
    }
    solve_single(error);
    if (again) {
        for (int i = 0; i < N; i++) changed[i] = state[i] + error[i];
        find_rate(t, changed, error);
        for (int i = 0; i < N; i++) error[i] += slopes[i];
        solve_single(error);
    }
    for (int i = 0; i < N; i++) {
        double size = magnitude(state[i]) > magnitude(next[i]) ? magnitude(state[i]) : magnitude(next[i]);
        double share = error[i] / (tolerance * (nominal[i] + size));
        sum += share * share;
    }
    return __builtin_sqrt(sum / N);
}

/* The change of the state over a share of the last step. */
static double move(int i, double share)
{
    return share * (polynomial[0][i] + share * (polynomial[1][i] + share * polynomial[2][i]));
}

static void widen(int span, const double *outputs)
{
    double *low = lows + OUTPUTS * span, *high = highs + OUTPUTS * span;
    for (int j = 0; j < OUTPUTS; j++) {
        if (outputs[j] < low[j]) low[j] = outputs[j];
        if (outputs[j] > high[j]) high[j] = outputs[j];
    }
}

/* It ends the span before it, and begins the next. */
static void write_row(int k, double t, const double *x)
{
    double *row = rows + OUTPUTS * k;
    CALL(output, t, x, inputs, parameters, row);
    if (k > 0) widen(k - 1, row);
    for (int j = 0; j < OUTPUTS && k < SAMPLES; j++) lows[OUTPUTS * k + j] = highs[OUTPUTS * k + j] = row[j];
}

/* The state to which the last two periods lead, by Anderson's method: the change that is left is taken for a
   line through theirs. It stays where they do not contract. */
static void extrapolate(bool known)
{
    double along = 0.0, size = 0.0, left = 0.0;
    for (int i = 0; i < N; i++) {
        double now = held[i] ? 0.0 : (state[i] - begun[i]) / (nominal[i] + magnitude(begun[i]));
        double by = now - shift[i];
        along += now * by;
        size += by * by;
        left += now * now;
        shift[i] = now;
    }
    double share = known && left < shifted && left < LITTLE ? along / size : 0.0;
    shifted = left;
    for (int i = 0; i < N; i++) {
        double led = state[i] - share * (state[i] - ended[i]);
        ended[i] = state[i];
        if (!held[i] && (!positive[i] || led > 0.0)) state[i] = led;
    }
}

/* Computes a period, whose outputs are the rows, from where the `before` periods of this search lead. Returns
   its largest change of a state that no period begins at its start, over nominal + |value|; NaN where no step
   succeeds, or too many are needed. */
double revolve(double period, double tolerance, int32_t before)
{
    if (before > 0) extrapolate(before > 1);
    double t = 0.0, h = period / SAMPLES, length = 0.0, last_error = 0.0, contraction = 1.0, most = 0.0;
    bool fresh = true, factored = false, refused = false;
    int k = 1;
    for (int i = 0; i < N; i++) begun[i] = state[i] = held[i] ? start[i] : state[i];
    write_row(0, t, state);
    find_rate(t, state, rate);
    find_jacobian(t);
    for (int steps = 0; k <= SAMPLES; steps++) {
        if (steps > MOST_STEPS || !(h > HOPELESS * period)) return __builtin_nan("");
        bool last = h >= period - t;
        if (last) h = period - t;
        if (!factored) factorise_both(h);
        factored = true;
        for (int s = 0; s < STAGES; s++)
            for (int i = 0; i < N; i++)
                stage[s][i] = length > 0.0 ? move(i, 1.0 + NODES[s] * h / length) - move(i, 1.0) : 0.0;
        int count = iterate(t, h, tolerance, &contraction);
        if (!count) {
            factored = false;
            if (fresh) h *= 0.5;
            else find_jacobian(t);
            fresh = true;
            contraction = 1.0;
            continue;
        }
        double found = estimate(t, h, tolerance, refused);
        double root = __builtin_sqrt(__builtin_sqrt(found < 1e-8 ? 1e-8 : found)); /* NaN shrinks the step */
        double factor = SAFETY * (2 * MOST_ITERATIONS + 1) / (2 * MOST_ITERATIONS + count) / root;
        refused = !(found <= 1.0);
        if (refused) {
            h *= factor > SMALLEST ? factor : SMALLEST;
            factored = false;
            continue;
        }
        if (last_error > 0.0) {
            double slower = h / length * __builtin_sqrt(__builtin_sqrt(last_error)) / root;
            if (slower < 1.0) factor *= slower;
        }
        transform(POWERS, stage, polynomial);
        for (; k <= SAMPLES && (last || t + h >= period * k / SAMPLES); k++) {
            double share = (period * k / SAMPLES - t) / h;
            for (int i = 0; i < N; i++) changed[i] = state[i] + move(i, share);
            write_row(k, period * k / SAMPLES, changed);
        }
        for (int i = 0; i < N; i++) state[i] += stage[2][i];
        t = last ? period : t + h;
        CALL(output, t, state, inputs, parameters, reached);
        widen(k <= SAMPLES ? k - 1 : SAMPLES - 1, reached);
        length = h;
        last_error = found > 1e-2 ? found : 1e-2;
        find_rate(t, state, rate);
        fresh = count > 2 && contraction > CONTRACTING;
        if (fresh) find_jacobian(t);
        if (fresh || factor >= KEPT || factor < 1.0) {
            double most_h = period / SAMPLES * MOST_SAMPLES;
            h *= factor < SMALLEST ? SMALLEST : factor > LARGEST ? LARGEST : factor;
            if (h > most_h) h = most_h;
            factored = false;
        }
    }
    for (int i = 0; i < N; i++) {
        double by = magnitude(state[i] - begun[i]) / (nominal[i] + magnitude(begun[i]));
        if (!held[i] && by > most) most = by;
    }
    return most;
}
