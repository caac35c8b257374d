//! The report of a study: what was declared and what came of it, who took part, and everything else, apart.
//!
//! It is a function of the data set alone: the same data and version give the same bytes.

mod exploratory;
mod items;
mod participants;
mod plan;
mod primary;
mod questionnaires;
mod within;
mod words;

use super::{Block, Document};
use crate::analysis::{Analysis, Options};
use crate::dataset::Dataset;
use crate::figures::{Colour, Conditions};
use crate::measures;
use crate::text::Text;
use cohelm::arbitration::Rule;

/// What every section of the report reads.
struct Study<'a> {
    data: &'a Dataset,
    analysis: Analysis,
    looks: Conditions,
}

/// The report of a study.
pub fn study_report(dataset: &Dataset, options: &Options) -> Document {
    let study = Study { data: dataset, analysis: Analysis::of(dataset, *options), looks: looks(dataset) };
    let design = &dataset.design;
    let title = design.title.read(design.first_language(), "en");
    let title = if title.is_empty() { design.name.as_str() } else { title };
    let marked = if dataset.simulated() { " (simulated participants)" } else { "" };
    let mut document = Document::new(format!("{title}{marked}"));
    document.lead = study.lead();
    document.facts = study.facts();
    if dataset.simulated() {
        document.push(Block::warning("Nobody took part: every participant is simulated", SIMULATED));
    }
    document.blocks.extend(interim(dataset));
    primary::write(&study, &mut document);
    participants::write(&study, &mut document);
    plan::write(&study, &mut document);
    exploratory::write(&study, &mut document);
    questionnaires::write(&study, &mut document);
    within::write(&study, &mut document);
    method(&study, options, &mut document);
    document
}

/// Fewest participants from which an interval by resampling means something.
const FEW: usize = 8;

/// What to keep in mind before the plan is fulfilled, or with few participants.
fn interim(dataset: &Dataset) -> Option<Block> {
    let (analysed, planned) = (dataset.analysed().len(), dataset.design.planned_participants as usize);
    if analysed > 0 && analysed < planned {
        let text = format!(
            "{analysed} of the {planned} planned participants are analysed. Whoever looks now and then, and stops when p falls \
             below the level, finds differences that are not there more often than that level says."
        );
        return Some(Block::note("An interim look", text));
    }
    (analysed > 0 && analysed < FEW).then(|| {
        let text = "Intervals by resampling from so few people are too narrow, and a test finds only very large differences.";
        Block::note("Few participants", text)
    })
}

const SIMULATED: &str = "The flights were flown by models of pilots, to try the study and its analysis. Nothing below says \
    anything about people. No questionnaire was answered, and no answer was invented. Do not report these numbers as results.";

/// One look a condition, the same in every figure: grey for the human alone, dark for the robot alone, colours for shared
/// control in the order of the design.
fn looks(dataset: &Dataset) -> Conditions {
    const SHARED: [Colour; 6] =
        [Colour::ORANGE, Colour::BLUE, Colour::GREEN, Colour::VERMILLION, Colour::SKY, Colour::PURPLE];
    let mut shared = SHARED.into_iter().cycle();
    let colour = |rule: &Rule| match rule {
        Rule::Hic => Colour::GREY,
        Rule::Robot => Colour::INK,
        _ => shared.next().unwrap_or(Colour::BLUE),
    };
    let colours: Vec<Colour> = dataset.design.conditions.iter().map(|c| &c.rule).map(colour).collect();
    let names = dataset.design.conditions.iter().map(|condition| condition.name.as_str());
    Conditions::with_colours(names.zip(colours))
}

impl Study<'_> {
    /// What this is and what came out, in two sentences.
    fn lead(&self) -> Text {
        let analysed = self.data.analysed().len();
        let who = match (self.data.simulated(), analysed) {
            (true, 1) => "1 simulated participant".to_owned(),
            (true, n) => format!("{n} simulated participants"),
            (false, 1) => "1 participant".to_owned(),
            (false, n) => format!("{n} participants"),
        };
        let modes = self.data.design.conditions.len();
        let modes = if modes == 1 { "one mode".to_owned() } else { format!("{modes} modes of control") };
        Text::from(format!("{who} flew {modes}. ")).then(primary::headline(self))
    }

    fn facts(&self) -> Vec<(String, String)> {
        let design = &self.data.design;
        let hash = design.hash();
        let fact = |name: &str, value: String| (name.to_owned(), value);
        vec![
            fact("Study", design.name.clone()),
            fact("Design", hash[..12.min(hash.len())].to_owned()),
            fact("Plant", design.task.task.plant.clone()),
            fact("Planned", format!("{} participants", design.planned_participants)),
            fact("Analysed", self.data.analysed().len().to_string()),
            fact("Flown with", self.data.program.clone()),
            fact("Report by", format!("cohelm {}", env!("CARGO_PKG_VERSION"))),
        ]
    }

    fn name(&self, condition: usize) -> &str {
        &self.data.design.conditions[condition].name
    }

    /// The looks of some conditions, by index.
    fn looks_of(&self, conditions: &[usize]) -> Conditions {
        let names: Vec<&str> = conditions.iter().map(|&condition| self.name(condition)).collect();
        self.looks.only(&names)
    }

    /// What goes below the title of every figure.
    fn people(&self) -> String {
        let (n, simulated) = (self.data.analysed().len(), self.data.simulated());
        let kind = if simulated { "simulated participant" } else { "participant" };
        format!("{n} {kind}{}", if n == 1 { "" } else { "s" })
    }
}

/// Adds a figure; where the data make none, a sentence says why.
fn push_figure(
    document: &mut Document,
    figure: Result<crate::figures::Figure, crate::figures::FigureError>,
    caption: impl Into<Text>,
    file: &str,
) {
    match figure {
        Ok(figure) => document.push(Block::figure(figure, caption, format!("figures/{file}"))),
        Err(why) => document.push(Block::paragraph(format!("No figure stands here: {why}."))),
    }
}

fn method(study: &Study<'_>, options: &Options, document: &mut Document) {
    document.push(Block::heading("How it was computed"));
    document.push(Block::paragraph(
        "Every flight was flown again from its key log and gave the stored bits; all measures come from these replays. A \
         participant’s value in a mode is the mean over the measured flights of that mode, and all tests are over participants’ \
         values. Tests within participants: repeated-measures ANOVA, with Greenhouse and Geisser’s correction from three modes \
         on; Friedman’s test; paired t tests and Wilcoxon’s signed-rank tests of all pairs, the former adjusted by Holm. \
         Equivalence: two one-sided t tests within the bound of the design. Effect size: the mean difference over the root mean \
         square of both standard deviations.",
    ));
    let bootstrap = options.bootstrap;
    document.push(Block::paragraph(format!(
        "Bootstrap intervals: {} resamples of participants, seed {}; of effect sizes corrected for bias and skew, of \
         interquartile means drawn within the groups of participants with the same order of modes. The one-way ANOVA takes the \
         modes for different people, as the paper on minimal intervention did; it stands here for comparison with it only.",
        bootstrap.resamples, bootstrap.seed
    )));
    document.push(Block::heading("What is measured"));
    let shown = std::iter::once(study.data.design.primary.measure.as_str())
        .chain(study.analysis.exploratory.iter().map(|outcome| outcome.quantity.key.as_str()));
    let defined: Vec<_> = measures::all().collect();
    let mut listed: Vec<_> = Vec::new();
    for key in shown {
        let found = defined.iter().find(|measure| measure.key == key);
        listed.extend(found.copied());
    }
    document.push(Block::measures(listed));
}
