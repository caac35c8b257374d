//! The five together: one tick of shared control.

use crate::action::Action;
use crate::ahead::Ahead;
use crate::arbitration::{Arbiter, GoalValues, Last, Likeness, LookAhead, Pick, Stage};
use crate::intent::{Belief, IntentModel, NearestGoal};
use crate::pilot::Pilot;
use crate::plant::{Plant, Step, View};
use crate::value::{ActionValues, NoOpinion, ValueModel};
use serde::{Deserialize, Serialize};

/// The assisting side: what infers intent, estimates values and arbitrates.
pub struct Cockpit {
    intent: Box<dyn IntentModel>,
    values: Box<dyn ValueModel>,
    arbiter: Box<dyn Arbiter>,
    silence: Silence,
    hides_goals: bool,
    likeness: Vec<Likeness>,
    allowed: Vec<bool>,
    now: ActionValues,
    of_goals: GoalSheet,
    last: Option<Last>,
}

/// What the shared modes carry out when the pilot asks for nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Silence {
    /// The co-pilot's best action, as in the paper (end of Section III-C).
    #[default]
    Best,
    /// Nothing.
    Nothing,
}

/// One tick, every stage of it.
#[derive(Clone, Copy, Debug)]
pub struct Tick<'a> {
    /// Ticks since the episode began.
    pub tick: u32,
    /// What the pilot asked for.
    pub asked: Option<Action>,
    /// What the co-pilot believed about the pilot's goal.
    pub belief: Belief,
    /// Whether the goal that was taken for the pilot's was its own, at this tick; of an imagined goal, whether the pilot's
    /// own is the nearest to it. For judges: no part of the co-pilot learns it.
    pub right: bool,
    /// What every candidate was worth for the inferred goal.
    pub values: &'a ActionValues,
    /// Which candidates passed the rule's threshold (A_threshold), in their order.
    pub allowed: &'a [bool],
    /// What reached the plant.
    pub executed: Option<Action>,
    /// How that differs from what was asked; `None` if nothing was.
    pub intervention: Option<Intervention>,
    /// What it brought.
    pub step: Step,
}

/// How what was carried out differs from what was asked, at a tick at which something was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Intervention {
    /// The plant is left set differently: this is what counts as an intervention.
    pub effective: bool,
    /// How differently, from 0 to 1: see [`ActionSpace::replaced`](crate::action::ActionSpace::replaced).
    pub replaced: f32,
    /// Another label, though perhaps with the same effect.
    pub nominal: bool,
    /// The opposite: similarity −1 (for axes: more against than along).
    pub opposed: bool,
}

impl Cockpit {
    /// A co-pilot made of its three parts.
    pub fn new(intent: Box<dyn IntentModel>, values: Box<dyn ValueModel>, arbiter: Box<dyn Arbiter>) -> Self {
        Self {
            intent,
            values,
            arbiter,
            silence: Silence::Best,
            hides_goals: false,
            likeness: Vec::new(),
            allowed: Vec::new(),
            now: ActionValues::none_yet(),
            of_goals: GoalSheet::default(),
            last: None,
        }
    }

    /// A cockpit in which nobody helps: no inference, no opinion, the given rule.
    pub fn unassisted(plant: &dyn Plant, arbiter: Box<dyn Arbiter>) -> Self {
        Self::new(Box::new(NearestGoal), Box::new(NoOpinion::new(plant.space())), arbiter)
    }

    /// The same with another answer to silence.
    pub fn with_silence(mut self, silence: Silence) -> Self {
        self.silence = silence;
        self
    }

    /// The same, but intent and values see no goal of the plant's: intent may imagine one
    /// ([`Belief::imagined`]), which is then the only goal that the values see.
    pub fn with_goals_hidden(mut self) -> Self {
        self.hides_goals = true;
        self
    }

    /// Begins an episode.
    pub fn begin(&mut self) {
        self.intent.begin();
        self.last = None;
    }

    /// Sees a tick that another cockpit flies: it infers the intent from what is asked there, and decides nothing. Who has
    /// looked on from the beginning of an episode knows at any later tick what it would have known.
    pub fn look_on(&mut self, plant: &dyn Plant, asked: Option<Action>, executed: Option<Action>) {
        let view = self.seen(plant.view());
        self.intent.infer(&view, asked);
        self.last = Some(last(plant, asked, executed));
    }

    /// What intent sees of a view.
    fn seen<'a>(&self, view: View<'a>) -> View<'a> {
        if self.hides_goals { View { goals: &[], ..view } } else { view }
    }

    /// What values see of a view: the goal that is imagined, if one is.
    fn seen_with<'a>(&self, belief: &'a Belief, view: View<'a>) -> View<'a> {
        let seen = self.seen(view);
        View { goals: belief.imagined_goal().map_or(seen.goals, std::slice::from_ref), ..seen }
    }

    /// One tick: the pilot asks; the co-pilot infers the intent and estimates values for it; arbitration decides; the
    /// plant moves.
    pub fn tick(&mut self, plant: &mut dyn Plant, pilot: &mut dyn Pilot) -> Tick<'_> {
        let view = plant.view();
        let tick = view.tick;
        let wanted = plant.pilot_goal();
        let asked = pilot.ask(&view, wanted);
        let belief = self.intent.infer(&self.seen(view), asked);
        let right = wanted < view.goals.len() && belief.goal_among(view.goals) == wanted;
        let seen = self.seen_with(&belief, view);
        self.now.copy_from(self.values.estimate(&seen, belief.goal, asked));
        self.allowed.clear();
        self.allowed.resize(self.now.candidates().len(), false);
        let executed = if asked.is_none() && self.silence == Silence::Nothing {
            self.allowed.fill(true);
            None
        } else {
            self.arbitrate(plant, asked, &belief)
        };
        let intervention = asked.map(|asked| intervention(plant, executed, asked));
        self.last = Some(last(plant, asked, executed));
        let step = plant.step(executed);
        let (values, allowed) = (&self.now, &self.allowed);
        Tick { tick, asked, belief, right, values, allowed, executed, intervention, step }
    }

    /// Sets the stage for the rule, with what it needs, and carries out what it picks.
    fn arbitrate(&mut self, plant: &dyn Plant, asked: Option<Action>, belief: &Belief) -> Option<Action> {
        let needs = self.arbiter.needs();
        compare(plant, &self.now, asked, &mut self.likeness);
        let of_goals = if needs.every_goal {
            let seen = self.seen_with(belief, plant.view());
            self.of_goals.fill(self.values.as_mut(), &seen, self.now.candidates(), asked)
        } else {
            None
        };
        let ahead = Ahead::new(plant, self.values.as_mut(), belief, self.now.candidates());
        let stage = Stage {
            values: &self.now,
            likeness: asked.map(|_| self.likeness.as_slice()),
            belief,
            of_goals,
            ahead: needs.look_ahead.then_some(&ahead as &dyn LookAhead),
            last: self.last,
        };
        carry_out(self.arbiter.decide(&stage, &mut self.allowed), plant, &self.now, asked)
    }
}

/// The candidates' values for every goal, goal by goal; kept so that a tick allocates nothing.
#[derive(Default)]
struct GoalSheet {
    all: Vec<f32>,
    of_one: Vec<f32>,
}

impl GoalSheet {
    fn fill(
        &mut self,
        model: &mut dyn ValueModel,
        view: &View<'_>,
        candidates: &[Action],
        asked: Option<Action>,
    ) -> Option<GoalValues<'_>> {
        self.all.clear();
        for goal in 0..view.goals.len() {
            model.assess(view, goal, candidates, asked, &mut self.of_one);
            self.all.extend_from_slice(&self.of_one);
        }
        GoalValues::new(&self.all, candidates.len())
    }
}

fn last(plant: &dyn Plant, asked: Option<Action>, executed: Option<Action>) -> Last {
    let intervened = asked.is_some_and(|asked| intervention(plant, executed, asked).effective);
    Last { asked, executed, intervened }
}

fn compare(plant: &dyn Plant, values: &ActionValues, asked: Option<Action>, likeness: &mut Vec<Likeness>) {
    likeness.clear();
    let Some(asked) = asked else { return };
    let wanted = plant.effect(Some(asked));
    likeness.extend(values.candidates().iter().map(|&candidate| Likeness {
        similarity: plant.similarity(candidate, asked),
        same_label: candidate == asked,
        same_effect: plant.effect(Some(candidate)) == wanted,
    }));
}

fn carry_out(pick: Pick, plant: &dyn Plant, values: &ActionValues, asked: Option<Action>) -> Option<Action> {
    match pick {
        Pick::Nothing => None,
        Pick::Asked => asked,
        Pick::Candidate(index) => Some(values.candidates()[index]),
        Pick::Blend { robot, weight } => {
            let robot = values.candidates()[robot];
            let heavier = |asked| if weight > 0.5 { robot } else { asked };
            Some(asked.map_or(robot, |asked| {
                plant.space().blend(robot, asked, weight).unwrap_or_else(|| heavier(asked))
            }))
        }
    }
}

fn intervention(plant: &dyn Plant, executed: Option<Action>, asked: Action) -> Intervention {
    let against = |executed: Action| match (executed, asked) {
        (Action::Axes(a), Action::Axes(b)) => a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>() < 0.0,
        _ => plant.similarity(executed, asked) <= -1.0,
    };
    let (effect, wanted) = (plant.effect(executed), plant.effect(Some(asked)));
    Intervention {
        effective: effect != wanted,
        replaced: plant.space().replaced(effect, wanted),
        nominal: executed != Some(asked),
        opposed: executed.is_some_and(against),
    }
}
