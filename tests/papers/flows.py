"""Every flow of the papers in numpy, written from their equations: slow, dense, and without any of our C++.

A mesh is x (n x 3 positions) and faces (m x 3, oriented alike). `free` (n, bool) are the vertices that may move
(Vollmer's V_var). Operators of unit 1/length^2 are multiplied by h^2, h the mean edge length, so that steps have
no unit; the papers leave the unit open. Where a paper is misprinted or silent, the function says what was taken.
"""

import numpy as np


class Mesh:
    """Connectivity, and what the papers read off the positions."""

    def __init__(self, n, faces):
        self.n, self.faces = n, faces
        self.adjacent = np.zeros((n, n), bool)
        for k in range(3):
            a, b = faces[:, k], faces[:, (k + 1) % 3]
            self.adjacent[a, b] = self.adjacent[b, a] = True
        self.degree = self.adjacent.sum(1)
        self.T = self.adjacent / self.degree[:, None]
        count = np.zeros((n, n), int)
        for k in range(3):
            a, b = faces[:, k], faces[:, (k + 1) % 3]
            np.add.at(count, (a, b), 1)
        count = count + count.T
        self.rim = ((count == 1) & self.adjacent).any(1)

    def edge(self, x):
        """h: mean length of the edges."""
        a, b = np.nonzero(np.triu(self.adjacent))
        return np.linalg.norm(x[a] - x[b], axis=1).mean()

    def corners(self, x):
        """Per corner of a face: vertex, next, last, vectors to them, the angle between them, the face's area."""
        for k in range(3):
            i, j, l = (self.faces[:, (k + s) % 3] for s in range(3))
            u, v = x[j] - x[i], x[l] - x[i]
            cross = np.linalg.norm(np.cross(u, v), axis=1)
            dot = (u * v).sum(1)
            yield i, j, l, u, v, cross, dot

    def normals(self, x):
        """Area-weighted vertex normals."""
        f = np.cross(x[self.faces[:, 1]] - x[self.faces[:, 0]], x[self.faces[:, 2]] - x[self.faces[:, 0]])
        sum_ = np.zeros((self.n, 3))
        for k in range(3):
            np.add.at(sum_, self.faces[:, k], f)
        return unit(sum_)

    def cotangents(self, x):
        """w_ij = cot alpha + cot beta, the angles opposite to the edge."""
        w = np.zeros((self.n, self.n))
        for _, j, l, _, _, cross, dot in self.corners(x):
            np.add.at(w, (j, l), dot / cross)
            np.add.at(w, (l, j), dot / cross)
        return w

    def ring_area(self, x):
        """A of Desbrun (14): all triangles around the vertex."""
        area = np.zeros(self.n)
        for i, _, _, _, _, cross, _ in self.corners(x):
            np.add.at(area, i, cross / 2)
        return area

    def mixed_area(self, x):
        """A_mixed of Zhao-Xu (38), Meyer et al.: Voronoi, or shares of an obtuse triangle."""
        area = np.zeros(self.n)
        angles = [np.arctan2(c[5], c[6]) for c in self.corners(x)]
        obtuse = np.max(angles, axis=0) > np.pi / 2
        for k, (i, _, _, u, v, cross, _) in enumerate(self.corners(x)):
            cot_j, cot_l = 1 / np.tan(angles[(k + 1) % 3]), 1 / np.tan(angles[(k + 2) % 3])
            voronoi = ((v * v).sum(1) * cot_j + (u * u).sum(1) * cot_l) / 8
            share = np.where(angles[k] > np.pi / 2, cross / 4, cross / 8)
            np.add.at(area, i, np.where(obtuse, share, voronoi))
        return area

    def angle_deficit(self, x):
        deficit = np.full(self.n, 2 * np.pi)
        for i, _, _, _, _, cross, dot in self.corners(x):
            np.add.at(deficit, i, -np.arctan2(cross, dot))
        return deficit

    def Hn(self, x):
        """Desbrun (14), Ohtake (8), Zhao-Xu (37): inward on a sphere, with the area of the one-ring."""
        return -(laplacian(self.cotangents(x)) @ x) / (4 * self.ring_area(x))[:, None]


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-300)


def laplacian(w):
    """S with (S x)_i = sum_j w_ij (x_i - x_j)."""
    return np.diag(w.sum(1)) - w


def move(x, step, free):
    return x + np.where(free[:, None], step, 0)


# Vollmer, Mencl, Mueller 1999


def vollmer_laplacian(mesh, x, free, steps, lambda_=1.0):
    """3.1, simultaneous."""
    for _ in range(steps):
        x = move(x, lambda_ * (mesh.T @ x - x), free)
    return x


def vollmer_sequential(mesh, x, free, steps):
    """3.1, sequential in the order of the vertices."""
    x = x.copy()
    for _ in range(steps):
        for i in np.nonzero(free)[0]:
            x[i] = x[mesh.adjacent[i]].mean(0)
    return x


def vollmer_centre(mesh, x, free, steps, alpha):
    """3.2: with the central point."""
    for _ in range(steps):
        x = move(x, alpha * x + (1 - alpha) * (mesh.T @ x) - x, free)
    return x


def vollmer_original(mesh, x, free, steps, alpha):
    """3.3: with the original point."""
    o = x
    for _ in range(steps):
        x = move(x, alpha * o + (1 - alpha) * (mesh.T @ x) - x, free)
    return x


def vollmer_push_back(mesh, p, q, o, free, alpha, beta):
    """The second half of algorithm 1 for any step from q to p (section 6)."""
    b = np.where(free[:, None], p - (alpha * o + (1 - alpha) * q), 0)
    return move(p, -(beta * b + (1 - beta) * (mesh.T @ b)), free)


def vollmer_pushed_back(mesh, x, free, steps, alpha, beta, step):
    o = x
    for _ in range(steps):
        x = vollmer_push_back(mesh, step(x), x, o, free, alpha, beta)
    return x


def vollmer_hc_step(mesh, q, o, free, alpha, beta):
    """Algorithm 1."""
    return vollmer_push_back(mesh, move(q, mesh.T @ q - q, free), q, o, free, alpha, beta)


def vollmer_hc(mesh, x, free, steps, alpha, beta):
    o = x
    for _ in range(steps):
        x = vollmer_hc_step(mesh, x, o, free, alpha, beta)
    return x


def vollmer_hc_limit(mesh, x, free, alpha, beta):
    """The fixed point of algorithm 1 (theorem 5.2), by solving x = HC(x), an affine map."""
    zero = np.zeros((mesh.n, 3))
    constant = vollmer_hc_step(mesh, np.where(free[:, None], 0, x), x, free, alpha, beta)
    matrix = np.zeros((mesh.n, mesh.n))
    for i in np.nonzero(free)[0]:
        e = zero.copy()
        e[i, 0] = 1
        matrix[:, i] = vollmer_hc_step(mesh, e, zero, free, alpha, beta)[:, 0]
    inside = np.nonzero(free)[0]
    result = x.copy()
    result[inside] = np.linalg.solve(np.eye(len(inside)) - matrix[np.ix_(inside, inside)], constant[inside])
    return result


# Ohtake, Belyaev, Bogaevski 2000


def ohtake_inverse_distance(mesh, x, free, steps, lambda_):
    """(1), (2), (4)."""
    for _ in range(steps):
        distance = np.linalg.norm(x[:, None] - x[None], axis=2)
        w = np.where(mesh.adjacent, 1 / np.where(mesh.adjacent, distance, 1), 0)
        x = move(x, lambda_ * ((w / w.sum(1)[:, None]) @ x - x), free)
    return x


def ohtake_taubin(mesh, x, free, steps, lambda_, mu):
    """(6): a step of lambda, then one of -mu."""
    for _ in range(steps):
        x = move(x, lambda_ * (mesh.T @ x - x), free)
        x = move(x, -mu * (mesh.T @ x - x), free)
    return x


def ohtake_bilaplacian(mesh, x, free, steps, lambda_):
    """Section 2: P - lambda U(U(P)); the printed plus amplifies. U of fixed vertices counts: nothing is said."""
    for _ in range(steps):
        u = mesh.T @ x - x
        x = move(x, -lambda_ * (mesh.T @ u - u), free)
    return x


def ohtake_curvature(mesh, x, free, steps, lambda_):
    """(7), (8)."""
    for _ in range(steps):
        x = move(x, lambda_ * mesh.edge(x) ** 2 * mesh.Hn(x), free)
    return x


def ohtake_modified(mesh, x, free, steps, lambda_, c):
    """(11), with n where (U0 . n) U0 is printed: the text calls the bracket the tangent projection."""
    for _ in range(steps):
        u, n = mesh.T @ x - x, mesh.normals(x)
        tangential = u - (u * n).sum(1)[:, None] * n
        x = move(x, lambda_ * (mesh.edge(x) ** 2 * mesh.Hn(x) + c * tangential), free)
    return x


def ohtake_median_speed(mesh, x, epsilon):
    """(13)."""
    hn, m = mesh.edge(x) ** 2 * mesh.Hn(x), unit(mesh.T @ x - x)
    h = np.linalg.norm(hn, axis=1)
    cosine = (m * unit(hn)).sum(1)
    along = (h / np.where(cosine == 0, 1, cosine))[:, None] * m
    speed = np.where((cosine > epsilon)[:, None], along, 0)
    # |H| m / cos theta with a negative cosine points against m: 2 H n minus it has the normal part H n.
    return np.where((cosine < -epsilon)[:, None], 2 * hn - along, speed)


def ohtake_median(mesh, x, free, steps, lambda_, epsilon):
    """(12)."""
    for _ in range(steps):
        x = move(x, lambda_ * ohtake_median_speed(mesh, x, epsilon), free)
    return x


def ohtake_ring_threshold(mesh, x, rings):
    """T of (14): mean of |H| over the first ring, or the first and second."""
    reach = mesh.adjacent
    if rings == 2:
        reach = (reach.astype(int) @ reach.astype(int) + reach) > 0
        np.fill_diagonal(reach, False)
    h = mesh.edge(x) ** 2 * np.linalg.norm(mesh.Hn(x), axis=1)
    return (reach @ h) / reach.sum(1)


def ohtake_threshold(mesh, x, free, steps, lambda_, threshold):
    """(14) around (7), T computed once."""
    for _ in range(steps):
        f = mesh.edge(x) ** 2 * mesh.Hn(x)
        size = np.linalg.norm(f, axis=1)
        x = move(x, lambda_ * (np.maximum(size - threshold, 0) / size)[:, None] * f, free)
    return x


# Desbrun, Meyer, Schroeder, Barr 1999


def desbrun_operator(mesh, x, kind):
    """-L of (7), (11), or the curvature normal (14), the latter two times h^2."""
    if kind == "umbrella":
        return np.eye(mesh.n) - mesh.T
    if kind == "scale-dependent":
        distance = np.where(mesh.adjacent, np.linalg.norm(x[:, None] - x[None], axis=2), 0)
        w = np.where(mesh.adjacent, 1 / np.where(mesh.adjacent, distance, 1), 0)
        return mesh.edge(x) ** 2 * laplacian(w) * (2 / distance.sum(1))[:, None]
    return mesh.edge(x) ** 2 * laplacian(mesh.cotangents(x)) / (4 * mesh.ring_area(x))[:, None]


def desbrun_implicit(mesh, x, free, steps, dt, kind, first, second):
    """(9) and 2.6: (I - first dt L + second dt L^2) X = X_n; rows of fixed vertices vanish (2.7)."""
    for _ in range(steps):
        op = np.where(free[:, None], desbrun_operator(mesh, x, kind), 0)
        x = np.linalg.solve(np.eye(mesh.n) + dt * (first * op + second * op @ op), x)
    return x


def desbrun_normalised(mesh, x, free, steps, lambda_):
    """5.5."""
    for _ in range(steps):
        w = mesh.cotangents(x)
        x = move(x, -lambda_ * (laplacian(w) @ x) / w.sum(1)[:, None], free)
    return x


# Zhao, Xu 2005


def zhao_xu_pull(mesh, x, m):
    """(2H)^(2m) (6m (2H^2 - K) + 2H^2) dA in units of h; dA and K with A_mixed (38), H of (37)."""
    h = mesh.edge(x)
    area = mesh.mixed_area(x)
    H2 = h * h * (mesh.Hn(x) ** 2).sum(1)
    K = np.where(mesh.rim, 0, h * h * mesh.angle_deficit(x) / area)  # (38) means nothing at a rim
    return area * (4 * H2) ** m * (6 * m * (2 * H2 - K) + 2 * H2), H2, K


def zhao_xu_directional(mesh, x, free, steps, s, m):
    """(3) with a of (33), made a unit vector. Its two minus signs (a = -A, P - s (a, n) H n) belong together."""
    for _ in range(steps):
        n, pull = mesh.normals(x), zhao_xu_pull(mesh, x, m)[0]
        a = unit((np.where(free, pull, 0)[:, None] * n).sum(0))
        x = move(x, s * mesh.edge(x) ** 2 * (n @ a)[:, None] * mesh.Hn(x), free)
    return x


def zhao_xu_local(mesh, x, free, steps, s, m, epsilon):
    """(34)-(36); the printed minus signs of a and of the step taken together."""
    ring = mesh.adjacent | np.eye(mesh.n, dtype=bool)
    for _ in range(steps):
        n, (pull, H2, K) = mesh.normals(x), zhao_xu_pull(mesh, x, m)
        b = unit(ring @ (pull[:, None] * n))
        w = np.where(np.abs(K) < epsilon, np.abs(K), 0)
        w = np.where(K >= epsilon, (1 + K) / ((1 + H2) * np.where(K == 0, 1, K)), w)
        x = move(x, s * mesh.edge(x) ** 2 * (w * (b * n).sum(1))[:, None] * mesh.Hn(x), free)
    return x


# Kobbelt 1997


def around(mesh, i):
    """The neighbours of i in the order of its faces, and whether they close."""
    after = {}
    for f in mesh.faces[(mesh.faces == i).any(1)]:
        k = int(np.nonzero(f == i)[0][0])
        after[f[(k + 1) % 3]] = f[(k + 2) % 3]
    start = next((j for j in after if j not in after.values()), min(after))
    order = [start]
    while order[-1] in after and after[order[-1]] != start:
        order.append(after[order[-1]])
    return order, start in after.values()


def kobbelt_chart(mesh, x, n, i, kind):
    """Section 4: orthogonal projection, exponential map by lengths and angles, even angles and lengths, or the mean
    of the last two, once the even one is turned to where the two fit best."""
    order, closed = around(mesh, i)
    d = x[order] - x[i]
    if kind == "tangent":
        e1 = unit(np.cross(n[i], np.eye(3)[np.argmin(np.abs(n[i]))]))
        return order, np.c_[d @ e1, d @ np.cross(n[i], e1)]
    length = np.linalg.norm(d, axis=1)
    turn = [np.arctan2(np.linalg.norm(np.cross(p, q)), p @ q) for p, q in zip(d, np.roll(d, -1, 0))]
    if not closed:
        turn = turn[:-1]
    total = sum(turn)
    scale = 2 * np.pi / total if closed else min(1, 2 * np.pi / total)
    angle = scale * np.r_[0, np.cumsum(turn)][: len(order)]
    true = length * np.exp(1j * angle)
    even = scale * total * np.arange(len(order)) / max(1, len(order) - (not closed))
    if closed:  # the one turn for which the directions of the two are closest
        even = even + np.angle(np.exp(1j * (angle - even)).sum())
    uniform = length.mean() * np.exp(1j * even)
    chart = {"exponential": true, "uniform": uniform, "mixed": (true + uniform) / 2}[kind]
    return order, np.c_[chart.real, chart.imag]


def kobbelt_fairing(mesh, x, free, dt, kind):
    """min sum w |x - q|^2 + dt h^4 sum w (|X_uu|^2 + 2 |X_uv|^2 + |X_vv|^2), w the mixed area.

    X_.. by a quadratic least-squares fit through the vertex. Valence 3 and 4 leave the fit open: of its solutions
    the one with the least second derivatives is taken (columns of the slopes weigh 1000 times as much).
    """
    n, h, w = mesh.normals(x), mesh.edge(x), mesh.mixed_area(x)
    energy = np.zeros((mesh.n, mesh.n))
    for i in range(mesh.n):
        order, uv = kobbelt_chart(mesh, x, n, i, kind)
        size = np.sqrt((uv**2).sum(1).mean())
        u, v = uv.T / size
        fit = np.linalg.pinv(np.c_[1e3 * u, 1e3 * v, u * u / 2, u * v / np.sqrt(2), v * v / 2], rcond=1e-9)
        rows = np.zeros((3, mesh.n))
        rows[:, order] = fit[2:] / size**2  # X_uu, sqrt(2) X_uv, X_vv
        rows[:, i] = -rows.sum(1)
        energy += w[i] * rows.T @ rows
    matrix, right = np.diag(w) + dt * h**4 * energy, w[:, None] * x
    result = x.copy()
    inside = np.nonzero(free)[0]
    right = right - matrix[:, ~free] @ x[~free]
    result[inside] = np.linalg.solve(matrix[np.ix_(inside, inside)], right[inside])
    return result
