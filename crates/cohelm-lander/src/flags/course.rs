//! What changes in the course of an episode: goals that appear and vanish, and the pilot's mind.
//!
//! All of it is drawn from the seed when the episode begins, so that it depends on nothing that anybody does.

use super::layout::purpose;
use super::options::FlagOptions;
use cohelm::random::Draws;

/// From when to when each pad is a goal, and which of them the pilot wants when.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Course {
    /// For each pad the first tick at which it is a goal, and the first at which it is none any more.
    spans: Vec<[u32; 2]>,
    /// From which tick on the pilot wants which pad; the first from tick 0.
    wishes: Vec<(u32, usize)>,
}

impl Course {
    /// Nothing changes: all pads are goals, and the pilot wants `first`.
    pub fn steady(pads: usize, first: usize) -> Self {
        Self { spans: vec![[0, u32::MAX]; pads], wishes: vec![(0, first)] }
    }

    /// What the options make of the episode of a seed, in which the pilot begins with wanting `first`.
    pub fn draw(seed: u64, options: &FlagOptions, first: usize) -> Self {
        let mut course = Self::steady(options.pads as usize, first);
        let mut draws = Draws::fork(seed, purpose::COURSE);
        if let Some(tick) = options.appears_at {
            let late = draws.below(course.spans.len() - 1);
            course.spans[late + usize::from(late >= first)][0] = tick;
        }
        let mind = options.changes_mind.map(|[from, to]| from + draws.below((to - from + 1) as usize) as u32);
        let mind_before = mind.filter(|mind| options.vanishes_at.is_none_or(|vanishes| *mind < vanishes));
        if let Some(tick) = mind_before {
            course.change_mind(tick, &mut draws);
        }
        if let Some(tick) = options.vanishes_at {
            let lost = draws.below(course.goals(tick).count());
            let lost = course.goals(tick).nth(lost).unwrap_or(first);
            course.spans[lost][1] = tick;
            if course.wanted(tick) == lost {
                course.change_mind(tick, &mut draws);
            }
        }
        if let Some(tick) = mind.filter(|_| mind_before.is_none()) {
            course.change_mind(tick, &mut draws);
        }
        course
    }

    /// From that tick on the pilot wants another of the goals there are then, each as likely; if there is none, the same.
    fn change_mind(&mut self, tick: u32, draws: &mut Draws) {
        let wanted = self.wanted(tick);
        let others: Vec<usize> = self.goals(tick).filter(|&pad| pad != wanted).collect();
        if !others.is_empty() {
            self.wishes.push((tick, others[draws.below(others.len())]));
        }
    }

    /// The pads that are goals at a tick, by x.
    pub fn goals(&self, tick: u32) -> impl Iterator<Item = usize> + '_ {
        let is_goal = move |pad: &usize| (self.spans[*pad][0]..self.spans[*pad][1]).contains(&tick);
        (0..self.spans.len()).filter(is_goal)
    }

    /// The pad that the pilot wants at a tick.
    pub fn wanted(&self, tick: u32) -> usize {
        let wish = self.wishes.iter().rev().find(|(from, _)| *from <= tick);
        wish.map_or(0, |&(_, pad)| pad)
    }

    /// From which tick on the pilot wants which pad.
    pub fn wishes(&self) -> &[(u32, usize)] {
        &self.wishes
    }

    /// Whether a pad is a goal from the first tick to the last.
    pub fn always(&self, pad: usize) -> bool {
        self.spans[pad] == [0, u32::MAX]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn courses(options: FlagOptions) -> impl Iterator<Item = Course> {
        (0..300).map(move |seed| Course::draw(seed, &options, (seed % 3) as usize))
    }

    #[test]
    fn without_options_nothing_changes() {
        for course in courses(FlagOptions::default()) {
            assert_eq!(course.goals(0).collect::<Vec<_>>(), [0, 1, 2]);
            assert_eq!(course.wishes().len(), 1);
            assert!((0..3).all(|pad| course.always(pad)));
        }
    }

    #[test]
    fn a_pad_appears_that_is_not_what_the_pilot_wanted_first() {
        for (seed, course) in courses(FlagOptions { appears_at: Some(60), ..Default::default() }).enumerate()
        {
            assert_eq!((course.goals(59).count(), course.goals(60).count()), (2, 3));
            assert!(course.goals(0).any(|pad| pad == seed % 3));
        }
    }

    #[test]
    fn whose_goal_vanishes_wants_another_from_that_tick_on() {
        let mut lost = 0;
        for (seed, course) in courses(FlagOptions { vanishes_at: Some(60), ..Default::default() }).enumerate()
        {
            assert_eq!((course.goals(59).count(), course.goals(60).count()), (3, 2));
            assert_eq!(course.wanted(59), seed % 3);
            assert!(course.goals(60).any(|pad| pad == course.wanted(60)));
            lost += usize::from(course.wanted(60) != course.wanted(59));
        }
        // 300 draws, p = 1/3: the standard deviation is 8.2.
        assert!((70..=130).contains(&lost), "{lost}");
    }

    #[test]
    fn the_mind_changes_once_in_its_span_to_a_goal_that_is_there() {
        let changing = FlagOptions { changes_mind: Some([40, 120]), ..Default::default() };
        for options in [changing, FlagOptions { vanishes_at: Some(80), ..changing }] {
            let mut ticks = std::collections::BTreeSet::new();
            for course in courses(options) {
                for pair in course.wishes().windows(2) {
                    ticks.insert(pair[1].0);
                    assert!((40..=120).contains(&pair[1].0) && pair[0].1 != pair[1].1);
                    assert!(course.goals(pair[1].0).any(|pad| pad == pair[1].1));
                }
                assert!((2..=3).contains(&course.wishes().len()));
            }
            assert!(ticks.len() > 70, "spread over the span");
        }
    }
}
