//! Whether a batch was answered to the end.

use crate::failure::Failure;
use ropewalk::Status;

/// What was cut short has no answer: better none at all than a file with a wrong one in it.
pub(crate) fn check(statuses: &[Status], things: &str) -> Result<(), Failure> {
    for (bit, what) in [
        (Status::STEP_BUDGET, "took more steps than the walk's budget"),
        (Status::STACK_OVERFLOW, "needed a deeper stack than the walk has"),
    ] {
        let count = statuses.iter().filter(|status| status.contains(bit)).count();
        if count > 0 {
            return Err(Failure::failed(format!(
                "{count} {things} {what} and have no answer: try another --walk or --device cpu; nothing was written"
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_answer_that_is_not_complete_is_enough() {
        assert!(check(&[], "rays").is_ok());
        assert!(check(&[Status::COMPLETE, Status::INVALID_RAY], "rays").is_ok());
        for bit in [Status::STEP_BUDGET, Status::STACK_OVERFLOW] {
            let failure = check(&[Status::COMPLETE, bit, bit], "points").unwrap_err();
            assert!(failure.message().starts_with("2 points "), "{}", failure.message());
        }
    }
}
