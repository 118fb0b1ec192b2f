// What went wrong with a ray, as a word: the twin of ropewalk's status.rs, from which the numbers come.
// Source: DESIGN, "nothing is cut off silently".
// Invariants: zero is a complete answer. Several bits may stand together.

const STATUS_COMPLETE: u32 = #{STATUS_COMPLETE};
const STATUS_INVALID_RAY: u32 = #{STATUS_INVALID_RAY};
const STATUS_STEP_BUDGET: u32 = #{STATUS_STEP_BUDGET};
const STATUS_STACK_OVERFLOW: u32 = #{STATUS_STACK_OVERFLOW};
