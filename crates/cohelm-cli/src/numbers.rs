//! Whole numbers on the command line, refused in words that say what may stand there.

use clap::Command;

/// Parses a whole number of a type that counts; `-1` and `3.5` are told what would do instead.
pub fn whole<Number: TryFrom<u64>>(text: &str) -> Result<Number, String> {
    let parsed = text.parse::<u64>().ok().and_then(|number| Number::try_from(number).ok());
    parsed.ok_or_else(|| format!("expected a whole number from 0 to {}", largest::<Number>()))
}

/// The largest number that fits: unsigned types end where a power of two does.
fn largest<Number: TryFrom<u64>>() -> u64 {
    let ends = [8, 16, 32, 64].map(|bits| u64::MAX >> (64 - bits));
    ends.into_iter().rev().find(|&end| Number::try_from(end).is_ok()).unwrap_or(0)
}

/// Lets every option take `-1` as its value, so that the option itself says what is wrong with it; otherwise `-1` would
/// be taken for an option that there is not.
pub fn with_negative_numbers(command: Command) -> Command {
    let command = command.mut_args(|arg| {
        let takes_value = arg.get_action().takes_values();
        if takes_value { arg.allow_negative_numbers(true) } else { arg }
    });
    command.mut_subcommands(with_negative_numbers)
}

#[cfg(test)]
mod tests {
    use super::whole;

    #[test]
    fn what_fits_is_taken_and_what_does_not_is_told_the_range() {
        assert_eq!(whole::<u16>("65535"), Ok(65_535));
        assert_eq!(whole::<u64>("18446744073709551615"), Ok(u64::MAX));
        for text in ["65536", "-1", "3.5", "", "many"] {
            assert_eq!(whole::<u16>(text), Err("expected a whole number from 0 to 65535".into()));
        }
        assert!(whole::<u32>("-1").unwrap_err().ends_with("from 0 to 4294967295"));
    }
}
