//! Starts near the goal that widen as they succeed.

use crate::options::NearGoal;
use cohelm::random::Draws;

/// How far from the goal episodes may begin by now.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curriculum {
    options: Option<NearGoal>,
    difficulty: f64,
    recent: Vec<bool>,
}

impl Curriculum {
    pub fn new(options: Option<NearGoal>) -> Self {
        Self {
            options,
            difficulty: options.map_or(1.0, |options| options.first.min(1.0)),
            recent: Vec::new(),
        }
    }

    /// The largest difficulty of a start by now; 1 means anything the plant can.
    pub fn difficulty(&self) -> f64 {
        self.difficulty
    }

    /// The difficulty of the next episode's start, or `None` for an ordinary one.
    pub fn next_start(&self, draws: &mut Draws) -> Option<f32> {
        let options = self.options?;
        let ordinary = if self.difficulty < 1.0 { options.ordinary } else { options.ordinary_at_last };
        let near = !draws.chance(ordinary);
        let difficulty = draws.uniform(0.0, self.difficulty);
        near.then_some(difficulty as f32)
    }

    /// Learns how an episode from a start of that difficulty went. Only the upper half counts: that the easy ones
    /// succeed is old news.
    pub fn note(&mut self, start: Option<f32>, success: bool) {
        let (Some(options), Some(start)) = (self.options, start) else { return };
        if f64::from(start) <= self.difficulty / 2.0 || self.difficulty >= 1.0 {
            return;
        }
        self.recent.push(success);
        let last = &self.recent[self.recent.len().saturating_sub(options.episodes)..];
        let share = last.iter().filter(|success| **success).count() as f64 / last.len() as f64;
        if last.len() >= options.episodes && share >= options.promote_at {
            self.difficulty =
                (self.difficulty + options.growth * f64::max(1.0, self.difficulty / 0.25)).min(1.0);
            self.recent.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ValueOptions;

    fn curriculum() -> Curriculum {
        Curriculum::new(ValueOptions::default().near_goal)
    }

    #[test]
    fn success_widens_the_starts_by_the_steps_of_the_recipe_and_failure_does_not() {
        let mut curriculum = curriculum();
        let mut steps = vec![curriculum.difficulty()];
        for _ in 0..1000 {
            let hard = curriculum.difficulty();
            curriculum.note(Some(hard as f32), true);
            if curriculum.difficulty() != hard {
                steps.push((curriculum.difficulty() * 100.0).round() / 100.0);
            }
        }
        assert_eq!(steps, [0.05, 0.15, 0.25, 0.35, 0.49, 0.69, 0.96, 1.0]);
        let mut failing = self::curriculum();
        (0..1000).for_each(|_| failing.note(Some(0.05), false));
        assert_eq!(failing.difficulty(), 0.05);
    }

    #[test]
    fn easy_and_ordinary_starts_do_not_count() {
        let mut curriculum = curriculum();
        for start in [Some(0.02), None] {
            (0..100).for_each(|_| curriculum.note(start, true));
        }
        assert_eq!(curriculum.difficulty(), 0.05);
    }

    #[test]
    fn without_the_option_every_start_is_ordinary() {
        let mut draws = Draws::new(1);
        assert!((0..50).all(|_| Curriculum::new(None).next_start(&mut draws).is_none()));
        let near = (0..500).filter_map(|_| curriculum().next_start(&mut draws)).collect::<Vec<_>>();
        assert!((400..490).contains(&near.len()) && near.iter().all(|&d| d < 0.05));
    }
}
