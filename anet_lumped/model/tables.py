"""Columns of every table that compiled code works on, each named once; `net` has the tables."""

# `Net.cable`, one row a cable: its first segment, number of segments and first interior node; the nodes of its start and its end;
# 1 if both are free points; the blocks (start, end) and (end, start) among those of the free points, -1 where there are none; the
# first row of its tension-strain curve in `Net.springs` and the one after the last, the same where it has no curve.
CABLE_FIRST_SEGMENT, CABLE_SEGMENTS, CABLE_FIRST_NODE, CABLE_START, CABLE_END = 0, 1, 2, 3, 4
CABLE_JOINS_FREE_POINTS, CABLE_BLOCK_START_END, CABLE_BLOCK_END_START, CABLE_CURVE, CABLE_CURVE_END = 5, 6, 7, 8, 9
CABLE_COLUMNS = 10

# `Net.axial`, one row a cable, the law of its segments: L0 [m], k [N/m], c [N s/m], the share of k that pushes, 1 for a damper that
# acts on slack segments too, the square of the highest frequency of a segment between the masses at its ends,
# k (1/m_a + 1/m_b) [1/s2]; 1 where the cable does not stretch (k and c are then 0); dL0/dt [m/s]; L0 at the start of a stage [m];
# d2L0/dt2 [m/s2].
AXIAL_L0, AXIAL_STIFFNESS, AXIAL_DAMPER, AXIAL_PUSH_SHARE, AXIAL_TWO_WAY_DAMPER = 0, 1, 2, 3, 4
AXIAL_OMEGA_SQUARED, AXIAL_INEXTENSIBLE, AXIAL_L0_RATE, AXIAL_L0_BEFORE = 5, 6, 7, 8
AXIAL_L0_ACCELERATION = 9
AXIAL_COLUMNS = 10

# `Net.springs`, one row a piece of a tension-strain curve: the strain that it acts from, and its share of k; and rows of working
# curves, see `Net.creep`.
CURVE_STRAIN, CURVE_SHARE = 0, 1

# `Net.creep`, one row a cable, of its segments, see `effects.laws.creep`: the static stiffness [N/m], 0 for a cable that does not
# creep; the stiffness of the fast spring without tension [N/m], by how much it grows with the tension [1/m]; the slow damper
# [N s/m]. And of a polyester rope, see `effects.laws.working_curve`: the rows of `Net.springs` where its original curve and the
# shape of its working curves begin, and the one after the last; the share of the stretch that stays, and the EA of working curves
# [N].
CREEP_STATIC, CREEP_FAST, CREEP_PER_TENSION, CREEP_DAMPER = range(4)
CREEP_ORIGINAL, CREEP_WORKING, CREEP_CURVES_END, CREEP_PERMANENT, CREEP_PARALLEL = 4, 5, 6, 7, 8
CREEP_COLUMNS = 9

# `Net.crept`, one row a segment: its slow stretch [m], how much that changed in the last step, and the largest tension that it has
# held for long [N], 0 but for a polyester rope with working curves.
CREPT_STRETCH, CREPT_CHANGE, CREPT_T_MAX = range(3)
CREPT_COLUMNS = 3

# `Net.segment`, one row a segment, its linearised law T = T_0 + k g . (d_j - d_i) along e: e and g (three columns each), the
# geometric stiffness a, k and T_0; and for the law the stretch before (of the old segment, or of its component along the new one),
# the stretch now, the conservative part of the tension, the change of length in the last step, and the numerical damper.
SEGMENT_DIRECTION, SEGMENT_GRADIENT, SEGMENT_GEOMETRIC, SEGMENT_STIFFNESS, SEGMENT_TENSION = 0, 3, 6, 7, 8
SEGMENT_STRETCH_BEFORE, SEGMENT_STRETCH, SEGMENT_CONSERVATIVE, SEGMENT_LAST_CHANGE, SEGMENT_NUMERICAL_DAMPER = 9, 10, 11, 12, 13
SEGMENT_COLUMNS = 14

# `Net.factor`, one row a segment, written by the elimination of the node behind it: the displacement of that node and the tension
# of the segment by the displacement of the next node. H (nine columns by rows) and h, of d = H d_next + h; w and T_c, of
# T = w . d_next + T_c.
FACTOR_PER_NEXT, FACTOR_CONSTANT, FACTOR_TENSION_PER_NEXT, FACTOR_TENSION_CONSTANT = 0, 9, 12, 15
FACTOR_COLUMNS = 16

# The row of `Net.factor` of the first segment of a cable between two free points, behind which no node is eliminated: its tension
# by the displacement of the cable's end, by that of its start, and the constant part.
FIRST_TENSION_PER_END, FIRST_TENSION_PER_START, FIRST_TENSION_CONSTANT = 0, 3, 6

# The columns of `Net.factor` that hold the direction of a segment while statics look for the forces of hanging chains.
FACTOR_DIRECTION = 0

# `Net.far_factor`, one row a segment, what is added to d and T above by the displacement of the next-but-one node: J (nine columns
# by rows) and o.
FAR_FACTOR_PER_SECOND, FAR_FACTOR_TENSION_PER_SECOND = 0, 9
FAR_FACTOR_COLUMNS = 12

# `Net.border`, one row a segment of a cable between two free points, what is added to d and T above by its BORDER_UNKNOWNS: the
# displacement of the cable's start and the tension of its first segment. Three rows of them for d, one for T.
BORDER_UNKNOWNS = 4
BORDER_TENSION = 3 * BORDER_UNKNOWNS
BORDER_COLUMNS = 4 * BORDER_UNKNOWNS

# `Net.linearised`, of the stage that was linearised last: its law, or LINEARISED_NO_LAW; its tau [s]; where the next stage stands,
# which is one of the three values below; the least share of the numerical damper in a step that begins; the step of
# `Net.mean_tension` [s], 0 if no mean was taken; 1 if no Newton step has been taken since, so that `Net.right_side` holds the
# forces of effects on driven nodes at the positions of now; what effects took over the step there, and their numerical dampers
# besides [J]; and the inertia of the stage over mass, W [1/s2].
LINEARISED_LAW, LINEARISED_TAU, LINEARISED_BEGINNING, LINEARISED_LEAST_DAMPER, LINEARISED_MEAN_STEP = range(5)
LINEARISED_CURRENT, LINEARISED_TAKEN, LINEARISED_TAKEN_BY_METHOD = 5, 6, 7
LINEARISED_W = 8
LINEARISED_COLUMNS = 9
LINEARISED_NO_LAW = -1.0

# In column LINEARISED_BEGINNING: the next stage belongs to a step that has been linearised before; it begins a step that follows
# another one; it begins a step that follows none.
LINEARISED_SAME_STEP, LINEARISED_NEXT_STEP, LINEARISED_FIRST_STEP = 0.0, 1.0, 2.0

# `Effects.address`, one row an effect: the addresses of its compiled functions, 0 for one that it does not have.
SLOT_FORCE, SLOT_TANGENT, SLOT_ENERGY, SLOT_WHOLE_STEP, SLOT_INERTIA, SLOT_SETTLE = range(6)

# `Lengths.material`, one row a cable whose rest length changes: its length [m], its EA [N] (0 if it does not stretch), the damper
# of a segment [N s/m], and 1 if that follows from BA, and so changes with the length.
MATERIAL_LENGTH, MATERIAL_EA, MATERIAL_DAMPER, MATERIAL_BA_GIVEN = range(4)

# Rows of `Lengths.paid`, one column a cable: the length paid out before, in the middle and at the end of a stage [m]; its rate
# [m/s].
PAID_BEFORE, PAID_MIDDLE, PAID_NOW, PAID_RATE = range(4)

# `Net.kernels`: addresses of the kernels that only some scenes need, 0 for one that a run does not, see `mechanics.optional`.
KERNEL_FORCE_SINGLES, KERNEL_FORCE_GROUPS, KERNEL_RESIDUAL_SINGLES, KERNEL_RESIDUAL_GROUPS = 0, 1, 2, 3
KERNEL_FINISH_SINGLES, KERNEL_FINISH_GROUPS, KERNEL_SETTLE_SINGLES, KERNEL_SETTLE_GROUPS = 4, 5, 6, 7
KERNEL_ELIMINATE_SINGLES, KERNEL_ELIMINATE_GROUPS, KERNEL_ELIMINATE_BORDERED = 8, 9, 10
KERNEL_SUBSTITUTE_SINGLES, KERNEL_SUBSTITUTE_GROUPS, KERNEL_SUBSTITUTE_BORDERED = 11, 12, 13
KERNEL_DRIVE, KERNEL_SET_LENGTHS, KERNEL_POWER_OF_LENGTHS, KERNEL_WORK_OF_LENGTHS, KERNEL_ENERGY_OF_PAID_OUT = 14, 15, 16, 17, 18
KERNEL_SETTLE_EFFECTS = 19
KERNEL_PLACE_BODIES, KERNEL_BALANCE_BODIES, KERNEL_REDUCE_BODIES, KERNEL_SPREAD_BODIES, KERNEL_FINISH_BODIES = 20, 21, 22, 23, 24
KERNEL_TURN_BODIES, KERNEL_STIFFEN_BODIES, KERNEL_FORCE_BODIES = 25, 26, 27
KERNEL_MOBILITY_BODIES, KERNEL_MEET_BODIES, KERNEL_PULL_BODIES, KERNEL_SHAPE_BODIES = 28, 29, 30, 31
KERNEL_RELINEARISE_CREEP, KERNEL_SETTLE_JOINTS, KERNEL_SOLVE_FRONTS = 32, 33, 34
KERNEL_FORCE_TRAILS, KERNEL_ELIMINATE_GROUPS_OF_INERTIA = 35, 36
KERNEL_OBSERVE_SINGLES, KERNEL_OBSERVE_GROUPS = 37, 38
KERNELS = 39

# `Fronts.front`, one row a front: how many points are its pivots and its rows; where its points begin in `Fronts.point`, its
# entries in `Fronts.entry` and its factors in `Fronts.factor`; the first front of those that are added to it, directly or not;
# where the rest that it leaves begins in `Fronts.waiting`.
FRONT_PIVOTS, FRONT_ROWS, FRONT_FIRST_POINT, FRONT_FIRST_ENTRY, FRONT_FIRST_FACTOR = range(5)
FRONT_FIRST_IN_SUBTREE, FRONT_WAITING_AT = 5, 6
FRONT_COLUMNS = 7

# `Bodies.joined`, one row a cable that ends at a body and at another moving point: the nodes of its start and end, the bodies that
# carry them or -1, the unknown (of the first of two, of a body) of each, the blocks of its nodes (start, end) and (end, start), and
# the blocks of the unknowns: see `body_order`.
JOINED_START, JOINED_END, JOINED_START_BODY, JOINED_END_BODY, JOINED_START_END, JOINED_END_START = range(6)
JOINED_TARGETS = 6  # (unknown of the start, unknown of the end) by rows, then (unknown of the end, unknown of the start): 2 x 4
JOINED_COLUMNS = 14

# `Bodies.state`, one row a body, of the stage that was placed last: its mass over the square of the step [kg/s2]; inertial force
# [N] and moment [N m]; the matrix of the moment over the turn (nine columns by rows), at first of inertia alone [N m]; radius of
# gyration [m]; and five numbers by which a Newton step is judged: inertial moment over the square of a turn [N m], sums of
# stiffness and of force times arm [N], [N m], and the last shift and turn [m], [rad]; the largest coordinate of its nodes [m]; and
# of a step of `LAW_BETWEEN` what it begins with: the reference point [m] and the angular velocity [rad/s]; force and moment that
# are out of balance, with the tensions by the law and with the predicted ones [N], [N m].
BODY_INERTIA, BODY_FORCE, BODY_MOMENT, BODY_TURNING, BODY_RADIUS, BODY_SECOND_ORDER, BODY_COORDINATE = 0, 1, 4, 7, 16, 17, 22
BODY_BEFORE, BODY_SPIN_BEFORE = 23, 26
BODY_BY_LAW, BODY_AS_PREDICTED = 29, 35
BODY_COLUMNS = 41

# `Bodies.joint`, one row a body that is pinned to a point which is no place of the world: the body and the other one, -1 for a
# fixed or driven point; the positions in `Bodies.node` of the points that meet, -1 likewise; the node that it is pinned to; the
# node that lends its row to the force of the joint; and the blocks (force, shift), (shift, force), (force, turn) and (turn, force)
# of the body and of the other one. The first bodies come first.
JOINT_BODY, JOINT_OTHER, JOINT_POSITION, JOINT_OTHER_POSITION, JOINT_OTHER_NODE, JOINT_UNKNOWN, JOINT_BLOCKS = range(7)
JOINT_COLUMNS = 14

# `Bodies.joint_pairs`, one row for two joints at one body: both, and the blocks (first, second) and (second, first) of their
# system.
JOINT_FIRST, JOINT_SECOND, JOINT_FIRST_SECOND, JOINT_SECOND_FIRST = range(4)

# `Bodies.jointed`, one row a body: its reference point [m]; the three matrices of `bodies.inertia.Inertia`; force and moment on it
# [N], [N m] or shift and turn by them; and its angular velocity [rad/s].
JOINTED_REFERENCE, JOINTED_INERTIA, JOINTED_FORCE, JOINTED_MOMENT, JOINTED_SPIN = 0, 3, 30, 33, 36
JOINTED_COLUMNS = 39

# `Links.unknown`, one row a cable: numbers of the first and of the last of its links among the end links, -1 for one that is not
# among them, and the entry of their system that joins both, -1 for none.
END_LINK_FIRST, END_LINK_LAST, END_LINKS_ENTRY = range(3)

# `Links.meeting`, one row for two end links that meet at a free point: its node, the two segments, the product of their signs there
# and the entry of the system that joins them.
MEETING_NODE, MEETING_FIRST, MEETING_SECOND, MEETING_SIGN, MEETING_ENTRY = range(5)

# `Links.body_meeting`, one row for two end links that end at the same body: the positions in `Bodies.node` of the nodes at which
# they do, the body, the two segments, the product of their signs there and the entry of the system that joins them. For one link
# with both ends on the body, the two segments are the same, and the last column holds its number among the end links.
BODY_MEETING_FIRST_NODE, BODY_MEETING_SECOND_NODE, BODY_MEETING_BODY, BODY_MEETING_FIRST, BODY_MEETING_SECOND = range(5)
BODY_MEETING_SIGN, BODY_MEETING_ENTRY = 5, 6
BODY_MEETING_COLUMNS = 7

# `Links.body`, one row a body: the three matrices of `bodies.inertia.Inertia`, nine columns each by rows.
LINKED_BODY_PER_MASS, LINKED_BODY_CARRIED, LINKED_BODY_TURNING = 0, 9, 18
LINKED_BODY_COLUMNS = 27

# `Links.state`: time that was prescribed last [s]; 1 if ``Links.tau`` belongs to it and to the state whose force was asked for
# last; largest component of an external force on a node then [N]; most redundant lengths found so far in a run.
LINKS_TIME, LINKS_CURRENT, LINKS_FORCE, LINKS_REDUNDANT = range(4)
LINKS_COLUMNS = 4
