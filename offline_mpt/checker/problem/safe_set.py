"""The safe set of a safety filter: within the ranges, left by no admissible input, and never without one."""
from balls import UNIT, Balls
from exact import dot, require
from filter_model import FilterModel
from polyhedron import Polyhedron, box_of, half_space, without_entry, without_implied


def confirm_safe_set(problem):
    """Shows what "Safety filters" in offline_mpt/checker/README.md says of the set."""
    model = FilterModel(problem)
    safe_set = Polyhedron(problem.set_rows(problem.size))
    require(safe_set.has_point(), "the safe set is empty")
    require_kept(problem, model)
    # So the set is bounded, too.
    require(all(map(safe_set.is_within, box_of(model.ranges, 0, problem.size))),
            "the safe set is not within the ranges less errors and excursions")
    for row in rows_with_an_input(problem):
        is_within = safe_set.is_within(row[:problem.size] + row[-1:])
        require(is_within, "a state of the safe set has no admissible input")


def greatest_in(value, radius, ends):
    """At least a x, where x is between the ends and a at most the radius from the value, both in units of 2^-BITS."""
    return (max(value * end for end in ends) + radius * max(map(abs, ends))) / UNIT


def require_kept(problem, model):
    """H_i xi+ <= k_i where G_i u <= b_i + M_i xi. For H_i (A xi + B u) = (G_i u - M_i xi) + (H_i A + M_i) xi + (H_i B - G_i) u,
    of which the first term is at most b_i, and the others have little left to multiply."""
    H = Balls.of(problem.H)
    on_xi, on_u, constant = H @ model.A + Balls.of(problem.M), H @ model.B - Balls.of(problem.G), H @ model.c
    allowed = [W + slack for W, slack in zip(model.W, model.slack)]
    for i, (row, bound) in enumerate(zip(problem.H, problem.k)):
        following = problem.b[i] + constant.upper(i, 0) + dot(map(abs, row), allowed)
        for balls, ranges in ((on_xi, model.ranges), (on_u, problem.inputs)):
            following += sum(greatest_in(value, balls.radius, own) for value, own in zip(balls.rows[i], ranges))
        require(following <= bound, f"row {i} of G, b, M does not keep row {i} of H, k")


def rows_with_an_input(problem):
    """What xi must meet so that an admissible input exists. The inputs, entries behind xi, are eliminated one by one."""
    n, nu = problem.size, len(problem.inputs)
    rows = problem.set_rows(n + nu) + box_of(problem.inputs, n, n + nu)
    admissible = zip(problem.M, problem.G, problem.b)
    rows += [half_space([*(-entry for entry in M), *G], bound) for M, G, bound in admissible]
    for j in range(n, n + nu):
        rows = without_entry(without_implied(rows) if j > n else rows, j)
    return rows
