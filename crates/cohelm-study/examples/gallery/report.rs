//! A report with every kind of block, its verdicts computed from the invented numbers.

use crate::Outcome;
use crate::figures;
use crate::invented::{participants, rates, values};
use cohelm_study::apa;
use cohelm_study::measures::{self, Measure, measure};
use cohelm_study::report::{Block, Document, VerdictRow, tables};
use cohelm_study::statistics::bootstrap::Options;
use cohelm_study::statistics::{Table, friedman, pairwise, repeated_measures};
use cohelm_study::text::Text;
use cohelm_study::verdict::{
    Comparison, Direction, Judgement, Limit, Part, difference_in_direction, each_part_holds,
    equivalent_within, every_participant, needs_people, under_settings,
};

const CONDITIONS: [&str; 3] = ["HIC", "LASC", "MISC"];

pub fn report() -> Outcome<Document> {
    let mut document = Document::new("Does minimal intervention reproduce?");
    document.lead = Text::from(
        "Ten simulated pilots flew the lander to one of three goals, alone and with a co-pilot under linear arbitration and \
         under minimal intervention. Of what the paper claims, the large effects return and the small ones do not.",
    );
    document.facts = [
        ("Participants", "10, simulated"),
        ("Episodes", "40 each and mode"),
        ("Seed", "2024"),
        ("Version", "0.1.0"),
    ]
    .map(|(name, value)| (name.to_owned(), value.to_owned()))
    .to_vec();
    document.push(Block::warning(
        "The pilots are simulated, and the numbers of this sample are invented.",
        "A simulated pilot has delays, habits and errors, but no opinion and no learning. What follows says what holds for such \
         pilots, not what people would do.",
    ));
    let data = Data::new()?;
    verdicts(&mut document, &data);
    results(&mut document, &data)?;
    methods(&mut document);
    Ok(document)
}

struct Data {
    success: Table,
    crash: Table,
    steps: Table,
}

impl Data {
    fn new() -> Outcome<Self> {
        let mut success = rates(&[0.0, 0.85, 0.86], 0.05);
        success[0].fill(Some(0.0));
        Ok(Data {
            success: table(&success)?,
            crash: table(&rates(&[0.91, 0.04, 0.05], 0.07))?,
            steps: table(&values(&[97.0, 238.0, 250.0], 22.0))?,
        })
    }
}

fn table(columns: &[Vec<Option<f64>>]) -> Outcome<Table> {
    let rows = (0..10).map(|p| columns.iter().map(|column| column[p]).collect()).collect();
    let conditions = CONDITIONS.map(str::to_owned).to_vec();
    Ok(Table::listwise(participants(), conditions, rows)?.table)
}

fn defined(key: &str) -> &'static Measure<'static> {
    measure(key).unwrap_or(&measures::OF_AN_EPISODE[0])
}

fn verdicts(document: &mut Document, data: &Data) {
    document.push(Block::heading("Claims and verdicts"));
    document.push(Block::paragraph(
        "Each verdict is computed by a rule that was fixed before the flights. “The same” needs an equivalence test: a large p of \
         a difference test is no proof of it.",
    ));
    let compare =
        |table, key, condition, against| Comparison { table, measure: defined(key), condition, against };
    let row = |claim: &str, paper: Text, judgement: Judgement| VerdictRow {
        claim: Text::from(claim),
        paper,
        judgement,
    };
    let success = compare(&data.success, "success", "MISC", "LASC");
    let same = equivalent_within(&success, 0.05);
    let unequal = equivalent_within(&compare(&data.success, "success", "MISC", "HIC"), 0.05);
    document.push(Block::Verdicts(vec![
        row(
            "Flying alone, every participant crashes in more than 80 % of the episodes.",
            Text::from("crash rates above 0.8 for all ten"),
            every_participant(&data.crash, defined("crash"), "HIC", Limit::Above(0.8)),
        ),
        row(
            "Sharing control greatly increases success.",
            Text::from("bars of Fig. 2a"),
            difference_in_direction(
                &compare(&data.success, "success", "MISC", "HIC"),
                Direction::Higher,
                0.5,
            ),
        ),
        row(
            "LASC and MISC succeed alike.",
            Text::new().em("F").plain(" = 0.05, ").em("p").plain(" = .8265"),
            under_settings(vec![
                ("the confidence is the paper’s inverse distance".to_owned(), unequal),
                ("the confidence is a peaked softmax".to_owned(), same),
            ]),
        ),
        row(
            "MISC needs fewer steps than LASC.",
            Text::new().em("F").plain(" = 8.65, ").em("p").plain(" = .0087"),
            difference_in_direction(&compare(&data.steps, "steps", "MISC", "LASC"), Direction::Lower, 0.0),
        ),
        row(
            "Neither dynamics nor human need a model.",
            Text::from("contribution 3"),
            each_part_holds(&parts()),
        ),
        row(
            "Participants are more satisfied with MISC.",
            Text::from("Table I: 7.8 against 8.6"),
            needs_people(0, || each_part_holds(&[])),
        ),
    ]));
}

fn parts() -> [Part; 2] {
    let part =
        |name: &str, holds, evidence: &str| Part { name: name.into(), holds, evidence: Text::from(evidence) };
    [
        part("the values", true, "The card of the value model names no pilot and no model of the dynamics."),
        part("the intent", false, "The card of the intent model names 1 560 flights of 30 simulated pilots."),
    ]
}

fn results(document: &mut Document, data: &Data) -> Outcome<()> {
    document.push(Block::heading("Success and crashes"));
    document.push(Block::paragraph(
        Text::from("All modes differ in success, ")
            .then(
                repeated_measures(&data.success)
                    .map_or_else(|why| apa::undefined(&why), |t| apa::repeated_measures(&t)),
            )
            .plain("; Friedman ")
            .then(friedman(&data.success).map_or_else(|why| apa::undefined(&why), |t| apa::friedman(&t)))
            .plain("."),
    ));
    document.push(Block::figure(
        figures::success_and_crash(&figures::three())?,
        "Success and crash rates of each participant in each mode, as the paper’s Fig. 2a.",
        "figures/fig2a",
    ));
    let success = defined("success");
    document.push(Block::Table(tables::summary(success, &data.success)));
    document
        .push(Block::Table(tables::pairs(success, &pairwise(&data.success, Some(0.05), Options::default()))));
    document.push(Block::heading("Steps"));
    document.push(Block::subheading("Each participant"));
    document.push(Block::figure(
        figures::steps(&figures::three())?,
        "Steps per episode, as Fig. 2b.",
        "figures/fig2b",
    ));
    document.push(Block::subheading("From LASC to MISC"));
    document.push(Block::figure(
        figures::slopes()?,
        "Success under both modes of shared control. The green band is where a difference counts as none.",
        "figures/slopes",
    ));
    document.push(Block::heading("Success against interventions"));
    document.push(Block::figure(figures::pareto()?, "All modes.", "figures/pareto"));
    Ok(())
}

fn methods(document: &mut Document) {
    document.push(Block::heading("Measures"));
    document.push(Block::measures(
        measures::OF_A_PARTICIPANT.iter().take(2).chain(&measures::OF_AN_EPISODE[3..9]),
    ));
    document.push(Block::heading("To make this again"));
    document.push(Block::Code("cargo run --release -p cohelm-study --example gallery FOLDER".into()));
    document.push(Block::note(
        "One-way or within",
        Text::from("The paper’s ")
            .em("p")
            .plain(" values are those of a one-way ANOVA with ")
            .em("df")
            .plain(" (1, 18), although the same ten people flew both modes; see ")
            .link("its page", "https://arxiv.org/abs/2105.00000")
            .plain("."),
    ));
    document.push(Block::List(vec![
        Text::from("Means over participants are what is tested."),
        Text::from("The column ").code("steps_of_successes").plain(" leaves crashes out."),
    ]));
}
