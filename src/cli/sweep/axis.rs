//! One parameter of a study and the values that it takes: `PATH=A..B:STEPS` or `PATH=A..B:STEPS:log`.

use std::str::FromStr;

use anyhow::anyhow;
use serde::{Deserialize, Serialize};

use crate::cli::Failure;
use crate::scene::{Scene, param, path};
use crate::text::echo;

/// The most values of one parameter.
const MAX_VALUES: usize = 10_000;
/// The most combinations of all parameters.
const MAX_RUNS: usize = 1_000_000;

/// One parameter and its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Axis {
    /// The path of the parameter in a scene.
    pub(super) path: String,
    pub(super) values: Vec<f64>,
    /// Whether the values are equal factors apart.
    pub(super) logarithmic: bool,
}

impl Axis {
    /// The parameter with its unit, for the axis of a plot.
    pub(super) fn title(&self) -> String {
        match param::find(&self.path).map_or("", |param| param.unit) {
            "" => self.path.clone(),
            unit => format!("{}, {unit}", self.path),
        }
    }

    /// Sets the parameter in a scene.
    pub(super) fn set(&self, scene: &mut Scene, value: f64) -> Result<(), Failure> {
        path::set(scene, &self.path, &value.to_string()).map_err(Failure::usage)
    }
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, range) = text.split_once('=').ok_or_else(wanted)?;
        let (ends, steps) = range.split_once(':').ok_or_else(wanted)?;
        let (steps, logarithmic) = match steps.split_once(':') {
            Some((steps, "log")) => (steps, true),
            Some(_) => return Err(wanted()),
            None => (steps, false),
        };
        let (first, last) = ends.split_once("..").ok_or_else(wanted)?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let (Some(first), Some(last)) = (number(first), number(last)) else { return Err(wanted()) };
        let steps: usize = steps.parse().map_err(|_no_number| wanted())?;
        if !(2..=MAX_VALUES).contains(&steps) {
            return Err(format!("{steps} values cannot be taken: ask for 2 to {MAX_VALUES}, both ends included"));
        }
        if first.total_cmp(&last).is_eq() {
            return Err(format!("from {first} to {last} there is one value only; use --set"));
        }
        if logarithmic && (first <= 0.0 || last <= 0.0) {
            return Err(format!("factors lead from {first} to {last} only where both are above 0; leave out :log"));
        }
        let values = (0..steps).map(|index| value([first, last], index as f64 / (steps - 1) as f64, logarithmic));
        Ok(Self { path: path.trim().to_owned(), values: values.collect(), logarithmic })
    }
}

fn wanted() -> String {
    "write PATH=A..B:STEPS, or PATH=A..B:STEPS:log for values that are factors apart; \
     for example settings.dt=1e-4..1e-2:5:log"
        .to_owned()
}

/// A value between the two ends, rounded to twelve digits: 0.3 rather than 0.30000000000000004.
fn value([first, last]: [f64; 2], share: f64, logarithmic: bool) -> f64 {
    let value = if logarithmic { first * libm::pow(last / first, share) } else { first + (last - first) * share };
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Refuses parameters that the scene does not have, and values outside their ranges.
pub(super) fn check(axes: &[Axis], scene: &Scene) -> Result<(), Failure> {
    for (index, axis) in axes.iter().enumerate() {
        if axes[..index].iter().any(|before| before.path == axis.path) {
            return Err(Failure::usage(anyhow!("--over {} is given twice", echo(&axis.path))));
        }
        for value in &axis.values {
            axis.set(&mut scene.clone(), *value)?;
        }
    }
    match runs(axes) {
        Some(_) => Ok(()),
        None => Err(Failure::usage(anyhow!("these are more than {MAX_RUNS} combinations; ask for fewer values"))),
    }
}

/// The number of combinations; none if there are too many.
fn runs(axes: &[Axis]) -> Option<usize> {
    let count = axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.values.len()));
    count.filter(|count| *count <= MAX_RUNS)
}

/// Every combination of the values; those of the last parameter change fastest.
pub(super) fn combinations(axes: &[Axis]) -> Vec<Vec<f64>> {
    let begin = vec![Vec::new()];
    axes.iter().fold(begin, |shorter, axis| {
        let longer = |values: &Vec<f64>| {
            let values = values.clone();
            axis.values.iter().map(move |value| values.iter().copied().chain([*value]).collect())
        };
        shorter.iter().flat_map(longer).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        text.parse::<Axis>().unwrap_or_else(|why| panic!("{text}: {why}")).values
    }

    #[test]
    fn values_are_round_and_both_ends_are_among_them() {
        assert_eq!(values("a=0.1..0.5:5"), [0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(values("a=1e-4..1e-2:3:log"), [1e-4, 1e-3, 1e-2]);
        assert_eq!(values("a=3..-3:4"), [3.0, 1.0, -1.0, -3.0], "downwards");
        assert_eq!(values("bodies.0.shape.cube.cells=2..32:5:log"), [2.0, 4.0, 8.0, 16.0, 32.0]);
    }

    #[test]
    fn what_is_no_range_is_refused_in_words() {
        for (text, word) in [
            ("a", "PATH="),
            ("a=1..2", "PATH="),
            ("a=1:3", "PATH="),
            ("a=1..2:3:lin", "PATH="),
            ("a=1..nan:3", "PATH="),
            ("a=1..2:x", "PATH="),
            ("a=1..2:1", "2 to 10000"),
            ("a=1..1:3", "--set"),
            ("a=0..2:3:log", "above 0"),
        ] {
            let why = text.parse::<Axis>().expect_err(text);
            assert!(why.contains(word), "{text}: {why}");
        }
    }

    #[test]
    fn every_combination_is_there_once_and_the_last_parameter_is_fastest() {
        let axes: Vec<Axis> = ["a=1..3:3", "b=0..1:2"].iter().map(|text| text.parse().expect("an axis")).collect();
        let all = combinations(&axes);
        assert_eq!(all, [[1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0], [3.0, 0.0], [3.0, 1.0]]);
        assert_eq!(runs(&axes), Some(6));
        let many: Vec<Axis> = (0..2).map(|_| "a=0..1:10000".parse().expect("an axis")).collect();
        assert_eq!(runs(&many), None, "a hundred million");
    }

    #[test]
    fn titles_carry_the_unit_of_the_table_of_parameters() {
        let title = |path: &str| format!("{path}=1..2:2").parse::<Axis>().expect("an axis").title();
        assert_eq!(title("settings.dt"), "settings.dt, s");
        assert_eq!(title("settings.gravity.1"), "settings.gravity.1, m/s²", "a component");
        assert_eq!(title("bodies.0.shape.cube.cells"), "bodies.0.shape.cube.cells", "a plain number");
    }
}
