//! How networks and the optimiser put themselves into a [`TensorFile`] and take themselves out.

use super::{TensorFile, WeightsError};
use crate::critic::{Critic, CriticShape};
use crate::dense::Layer;
use crate::lstm::{Lstm, LstmShape};
use crate::mlp::{Head, MAX_HIDDEN_LAYERS, Mlp, MlpShape};

impl Mlp {
    /// Puts the parameters into `file` as `{prefix}hidden.0.weight`, … (names in `docs/networks.md`).
    pub fn save(&self, file: &mut TensorFile, prefix: &str) {
        for (slot, name) in slots(self.shape(), prefix) {
            slot.save(self.params(), &name, file);
        }
    }

    /// Takes a network out of `file`; its shape is what the tensors say.
    ///
    /// # Errors
    /// A tensor that is missing, has a wrong shape, or lies under the prefix without belonging to the network.
    pub fn load(file: &TensorFile, prefix: &str) -> Result<Self, WeightsError> {
        let shape = mlp_shape(file, prefix)?;
        let slots = slots(&shape, prefix);
        check_tensors(file, prefix, &slots)?;
        let mut net = Self::zeros(&shape);
        for (slot, name) in &slots {
            slot.load(net.params_mut(), name, file)?;
        }
        Ok(net)
    }
}

/// The shape that the tensors under the prefix have.
fn mlp_shape(file: &TensorFile, prefix: &str) -> Result<MlpShape, WeightsError> {
    let mut hidden = Vec::new();
    let mut input = None;
    // One more than allowed, so that a deeper file is refused for its depth.
    while hidden.len() <= MAX_HIDDEN_LAYERS {
        let name = format!("{prefix}hidden.{}.weight", hidden.len());
        if file.find(&name).is_err() {
            break;
        }
        let (outputs, inputs) = matrix_shape(file, &name)?;
        input.get_or_insert(inputs);
        hidden.push(outputs);
    }
    let plain = format!("{prefix}output.weight");
    let dueling = format!("{prefix}advantage.weight");
    let is_plain = file.find(&plain).is_ok();
    let (outputs, inputs) = matrix_shape(file, if is_plain { &plain } else { &dueling })?;
    let head = if is_plain { Head::Plain(outputs) } else { Head::Dueling(outputs) };
    Ok(MlpShape::new(input.unwrap_or(inputs), &hidden, head)?)
}

impl Critic {
    /// Puts the parameters into `file` as `{prefix}state.hidden.0.weight`, …, `{prefix}action.weight` (names in
    /// `docs/networks.md`).
    pub fn save(&self, file: &mut TensorFile, prefix: &str) {
        for (slot, name) in critic_slots(self.shape(), prefix) {
            slot.save(self.params(), &name, file);
        }
    }

    /// Takes a critic out of `file`; its shape is what the tensors say.
    ///
    /// # Errors
    /// A tensor that is missing, has a wrong shape, or lies under the prefix without belonging to the critic.
    pub fn load(file: &TensorFile, prefix: &str) -> Result<Self, WeightsError> {
        let state = mlp_shape(file, &format!("{prefix}state."))?;
        let (width, action) = matrix_shape(file, &format!("{prefix}action.weight"))?;
        let shape = CriticShape::new(state.input(), state.hidden(), action, width)?;
        let slots = critic_slots(&shape, prefix);
        check_tensors(file, prefix, &slots)?;
        let mut critic = Self::zeros(&shape);
        for (slot, name) in &slots {
            slot.load(critic.params_mut(), name, file)?;
        }
        Ok(critic)
    }
}

impl Lstm {
    /// Puts the parameters into `file` as `{prefix}lstm.weight_ih_l0`, … (names in `docs/networks.md`).
    pub fn save(&self, file: &mut TensorFile, prefix: &str) {
        for (slot, name) in lstm_slots(self.shape(), prefix) {
            slot.save(self.params(), &name, file);
        }
    }

    /// Takes a network out of `file`; its shape is what the tensors say.
    ///
    /// # Errors
    /// A tensor that is missing, has a wrong shape, or lies under the prefix without belonging to the network.
    pub fn load(file: &TensorFile, prefix: &str) -> Result<Self, WeightsError> {
        let (_, input) = matrix_shape(file, &format!("{prefix}lstm.weight_ih_l0"))?;
        let (_, hidden) = matrix_shape(file, &format!("{prefix}lstm.weight_hh_l0"))?;
        let (output, _) = matrix_shape(file, &format!("{prefix}head.weight"))?;
        let shape = LstmShape::new(input, hidden, output)?;
        let slots = lstm_slots(shape, prefix);
        check_tensors(file, prefix, &slots)?;
        let mut net = Self::zeros(shape);
        for (slot, name) in &slots {
            slot.load(net.params_mut(), name, file)?;
        }
        Ok(net)
    }
}

/// One stored tensor: some outputs of a layer, either their weights from some of the inputs or their biases.
struct Slot {
    layer: Layer,
    /// First output and their number.
    outputs: (usize, usize),
    /// First input and their number; none for biases.
    inputs: Option<(usize, usize)>,
}

impl Slot {
    fn shape(&self) -> Vec<usize> {
        match self.inputs {
            Some((_, inputs)) => vec![self.outputs.1, inputs],
            None => vec![self.outputs.1],
        }
    }

    /// Indices into the flat parameters in the order in which the tensor stores them, `[outputs][inputs]`.
    fn indices(&self) -> impl Iterator<Item = usize> {
        let Layer { start, outputs: width, inputs: all } = self.layer;
        let (first_output, outputs) = self.outputs;
        // Biases lie behind the weights like one more input.
        let (first_input, inputs) = self.inputs.unwrap_or((all, 1));
        (first_output..first_output + outputs)
            .flat_map(move |o| (first_input..first_input + inputs).map(move |i| start + i * width + o))
    }

    fn save(&self, params: &[f32], name: &str, file: &mut TensorFile) {
        file.insert(name, &self.shape(), self.indices().map(|i| params[i]).collect());
    }

    fn load(&self, params: &mut [f32], name: &str, file: &TensorFile) -> Result<(), WeightsError> {
        for (i, &x) in self.indices().zip(file.tensor(name, &self.shape())?) {
            params[i] = x;
        }
        Ok(())
    }
}

/// Weights and biases of some outputs of a layer under one name.
fn pair(layer: Layer, outputs: (usize, usize), name: &str) -> [(Slot, String); 2] {
    let weight = Slot { layer, outputs, inputs: Some((0, layer.inputs)) };
    let bias = Slot { layer, outputs, inputs: None };
    [(weight, format!("{name}.weight")), (bias, format!("{name}.bias"))]
}

fn slots(shape: &MlpShape, prefix: &str) -> Vec<(Slot, String)> {
    let layers = shape.layers();
    let (&head, hidden) = layers.split_last().expect("a shape has a head");
    let mut slots = Vec::new();
    for (i, &layer) in hidden.iter().enumerate() {
        slots.extend(pair(layer, (0, layer.outputs), &format!("{prefix}hidden.{i}")));
    }
    match shape.head() {
        Head::Plain(n) => slots.extend(pair(head, (0, n), &format!("{prefix}output"))),
        Head::Dueling(n) => {
            slots.extend(pair(head, (0, n), &format!("{prefix}advantage")));
            slots.extend(pair(head, (n, 1), &format!("{prefix}value")));
        }
    }
    slots
}

fn critic_slots(shape: &CriticShape, prefix: &str) -> Vec<(Slot, String)> {
    let mut slots = slots(shape.state_tower(), &format!("{prefix}state."));
    slots.extend(pair(shape.action_layer(), (0, shape.width()), &format!("{prefix}action")));
    slots
}

fn lstm_slots(shape: LstmShape, prefix: &str) -> Vec<(Slot, String)> {
    let gates = shape.gates();
    let all = (0, gates.outputs);
    let mut slots = vec![
        (
            Slot { layer: gates, outputs: all, inputs: Some((0, shape.input())) },
            format!("{prefix}lstm.weight_ih_l0"),
        ),
        (
            Slot { layer: gates, outputs: all, inputs: Some((shape.input(), shape.hidden())) },
            format!("{prefix}lstm.weight_hh_l0"),
        ),
        (Slot { layer: gates, outputs: all, inputs: None }, format!("{prefix}lstm.bias_ih_l0")),
    ];
    slots.extend(pair(shape.head(), (0, shape.output()), &format!("{prefix}head")));
    slots
}

/// Outputs and inputs of a weight matrix.
fn matrix_shape(file: &TensorFile, name: &str) -> Result<(usize, usize), WeightsError> {
    match file.find(name)?.shape[..] {
        [outputs, inputs] => Ok((outputs, inputs)),
        _ => Err(file.wrong_shape(name, "[outputs, inputs]".to_owned())),
    }
}

/// Every tensor of the network is there with its shape, and nothing else is under the prefix. Seen before
/// anything is allocated: the widths alone could ask for far more than the file holds.
fn check_tensors(file: &TensorFile, prefix: &str, slots: &[(Slot, String)]) -> Result<(), WeightsError> {
    for (slot, name) in slots {
        file.tensor(name, &slot.shape())?;
    }
    let known = |name: &str| slots.iter().any(|(_, slot)| slot == name);
    match file.names().find(|name| name.starts_with(prefix) && !known(name)) {
        None => Ok(()),
        Some(name) => Err(WeightsError::UnexpectedTensor { name: name.to_owned() }),
    }
}

#[cfg(feature = "train")]
mod adam {
    use super::{TensorFile, WeightsError};
    use crate::adam::{Adam, AdamOptions};

    impl Adam {
        /// Puts constants, steps and moments into `file`; going on from them is going on to the bit.
        ///
        /// The moments are flat, in the layout of the network's parameters.
        pub fn save(&self, file: &mut TensorFile, prefix: &str) {
            let AdamOptions { beta1, beta2, epsilon, largest_norm } = self.options();
            // Rust prints the shortest decimal that reads back as the same number.
            file.set(format!("{prefix}beta1"), beta1.to_string());
            file.set(format!("{prefix}beta2"), beta2.to_string());
            file.set(format!("{prefix}epsilon"), epsilon.to_string());
            file.set(format!("{prefix}largest_norm"), largest_norm.map_or("none".into(), |n| n.to_string()));
            file.set(format!("{prefix}steps"), self.steps().to_string());
            let (mean, mean_square) = self.moments();
            file.insert(format!("{prefix}mean"), &[mean.len()], mean.to_vec());
            file.insert(format!("{prefix}mean_square"), &[mean.len()], mean_square.to_vec());
        }

        /// Takes an optimiser for this many parameters out of `file`.
        ///
        /// # Errors
        /// Missing or unreadable metadata, moments that are missing or of another length.
        pub fn load(file: &TensorFile, prefix: &str, parameters: usize) -> Result<Self, WeightsError> {
            let number = |name: &str, expected, valid: fn(f32) -> bool| {
                parse(file, &format!("{prefix}{name}"), expected, |&x: &f32| valid(x))
            };
            let decay = |x: f32| (0.0..1.0).contains(&x);
            let positive = |x: f32| x > 0.0 && x.is_finite();
            let largest_norm = match file.get(&format!("{prefix}largest_norm"))? {
                "none" => None,
                _ => Some(number("largest_norm", "a positive number or \"none\"", positive)?),
            };
            let options = AdamOptions {
                beta1: number("beta1", "a number from 0 to below 1", decay)?,
                beta2: number("beta2", "a number from 0 to below 1", decay)?,
                epsilon: number("epsilon", "a positive number", positive)?,
                largest_norm,
            };
            let steps = parse(file, &format!("{prefix}steps"), "a count", |_| true)?;
            let moment = |name: &str| file.tensor(&format!("{prefix}{name}"), &[parameters]);
            Ok(Self::restore(options, steps, moment("mean")?.to_vec(), moment("mean_square")?.to_vec()))
        }
    }

    fn parse<T: std::str::FromStr>(
        file: &TensorFile,
        key: &str,
        expected: &'static str,
        valid: impl FnOnce(&T) -> bool,
    ) -> Result<T, WeightsError> {
        let text = file.get(key)?;
        let wrong = || WeightsError::Metadata { key: key.to_owned(), expected, found: text.to_owned() };
        text.parse().ok().filter(valid).ok_or_else(wrong)
    }
}
