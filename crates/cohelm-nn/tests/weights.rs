//! Files of weights: what is written comes back to the bit, and nothing else comes in.

use cohelm_nn::lstm::{Lstm, LstmShape};
use cohelm_nn::mlp::{Head, Mlp, MlpShape};
use cohelm_nn::shape::ShapeError;
use cohelm_nn::weights::{FORMAT_KEY, FORMAT_VERSION, MAX_HEADER_BYTES, TensorFile, WeightsError};
use proptest::prelude::*;

fn uniform(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    }
}

fn mlp() -> Mlp {
    Mlp::new(&MlpShape::new(3, &[4, 5], Head::Dueling(2)).unwrap(), uniform(1))
}

fn lstm() -> Lstm {
    Lstm::new(LstmShape::new(3, 4, 2).unwrap(), uniform(2))
}

fn mlp_file() -> TensorFile {
    let mut file = TensorFile::new();
    mlp().save(&mut file, "");
    file
}

fn read(bytes: &[u8]) -> Result<Mlp, WeightsError> {
    Mlp::load(&TensorFile::from_bytes(bytes)?, "")
}

/// A file around a header of any text and data of any bytes.
fn raw(header: &str, data: &[u8]) -> Vec<u8> {
    [&(header.len() as u64).to_le_bytes(), header.as_bytes(), data].concat()
}

#[test]
fn networks_side_by_side_come_back_to_the_bit() {
    let mut file = TensorFile::new();
    mlp().save(&mut file, "online.");
    lstm().save(&mut file, "intent.");
    file.set("seed", "17 \"quoted\"\nand on two lines, ü");
    let again = TensorFile::from_bytes(&file.to_bytes().unwrap()).unwrap();
    assert_eq!(again, file);
    assert_eq!(Mlp::load(&again, "online."), Ok(mlp()));
    assert_eq!(Lstm::load(&again, "intent."), Ok(lstm()));
    assert_eq!(again.get("seed"), Ok("17 \"quoted\"\nand on two lines, ü"));
}

#[test]
fn plain_and_layerless_networks_come_back() {
    for (hidden, head) in [(&[][..], Head::Plain(3)), (&[], Head::Dueling(1)), (&[6], Head::Plain(1))] {
        let net = Mlp::new(&MlpShape::new(2, hidden, head).unwrap(), uniform(3));
        let mut file = TensorFile::new();
        net.save(&mut file, "");
        assert_eq!(read(&file.to_bytes().unwrap()), Ok(net));
    }
}

/// What `docs/networks.md` promises to other readers.
#[test]
fn names_and_orientation_are_those_of_the_docs() {
    let (file, net) = (mlp_file(), mlp());
    let names: Vec<_> = file.names().collect();
    assert_eq!(
        names,
        [
            "advantage.bias",
            "advantage.weight",
            "hidden.0.bias",
            "hidden.0.weight",
            "hidden.1.bias",
            "hidden.1.weight",
            "value.bias",
            "value.weight",
        ]
    );
    // Flat parameters are input-major, [3][4]; stored is [4][3].
    let stored = file.tensor("hidden.0.weight", &[4, 3]).unwrap();
    assert_eq!(stored[3 * 2 + 1], net.params()[4 + 2]);

    let mut file = TensorFile::new();
    lstm().save(&mut file, "");
    let names: Vec<_> = file.names().collect();
    assert_eq!(
        names,
        ["head.bias", "head.weight", "lstm.bias_ih_l0", "lstm.weight_hh_l0", "lstm.weight_ih_l0"]
    );
    assert!(
        file.tensor("lstm.weight_ih_l0", &[16, 3]).is_ok() && file.tensor("head.weight", &[2, 4]).is_ok()
    );
}

#[test]
fn the_same_content_gives_the_same_bytes() {
    let build = |keys: &[&str]| {
        let mut file = mlp_file();
        keys.iter().for_each(|&key| file.set(key, "1"));
        file.to_bytes().unwrap()
    };
    assert_eq!(build(&["a", "b", "c", "d", "e"]), build(&["e", "c", "a", "d", "b"]));
    let data = build(&[]);
    let header = u64::from_le_bytes(data[..8].try_into().unwrap());
    assert_eq!(header % 8, 0, "the data begins at a multiple of eight");
}

#[test]
fn a_diverged_network_is_not_saved() {
    let mut net = mlp();
    net.params_mut()[5] = f32::INFINITY;
    let mut file = TensorFile::new();
    net.save(&mut file, "");
    assert!(matches!(file.to_bytes(), Err(WeightsError::NotFinite { value: f32::INFINITY, .. })));
}

#[test]
fn nan_in_a_file_is_refused() {
    let mut bytes = mlp_file().to_bytes().unwrap();
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read(&bytes).unwrap_err();
    assert_eq!(error.to_string(), "tensor \"value.weight\" holds NaN at 4; weights must be finite");
}

#[test]
fn no_safetensors_at_all() {
    assert!(matches!(read(b""), Err(WeightsError::Format(_))));
    assert!(matches!(read(b"PK\x03\x04"), Err(WeightsError::Format(_))));
    assert!(matches!(read(&raw("{", b"")), Err(WeightsError::Format(_))));
    assert!(matches!(read(&raw("\u{1F6F8}", b"")), Err(WeightsError::Format(_))));
    // A picture's first eight bytes, taken for a length.
    assert!(matches!(read(b"\x89PNG\r\n\x1a\n rest"), Err(WeightsError::HeaderSize { .. })));
}

#[test]
fn a_header_too_large_is_refused_before_it_is_read() {
    let mut bytes = mlp_file().to_bytes().unwrap();
    bytes[..8].copy_from_slice(&(MAX_HEADER_BYTES as u64 + 1).to_le_bytes());
    assert_eq!(read(&bytes), Err(WeightsError::HeaderSize { found: MAX_HEADER_BYTES as u64 + 1 }));
    let mut file = mlp_file();
    file.set("card", "x".repeat(MAX_HEADER_BYTES));
    assert!(matches!(file.to_bytes(), Err(WeightsError::HeaderSize { .. })));
}

#[test]
fn safetensors_of_others_and_of_other_versions() {
    let foreign = raw(r#"{"__metadata__":{"format":"pt"}}"#, b"");
    assert_eq!(read(&foreign), Err(WeightsError::Foreign));
    let none = raw("{}", b"");
    assert_eq!(read(&none), Err(WeightsError::Foreign));
    let old = raw(&format!("{{\"__metadata__\":{{\"{FORMAT_KEY}\":\"0\"}}}}"), b"");
    assert_eq!(read(&old), Err(WeightsError::Version { found: "0".into() }));
}

#[test]
fn a_tensor_of_another_type() {
    let header = format!(
        "{{\"__metadata__\":{{\"{FORMAT_KEY}\":\"{FORMAT_VERSION}\"}},\
         \"output.weight\":{{\"dtype\":\"F16\",\"shape\":[1,2],\"data_offsets\":[0,4]}}}}"
    );
    let error = read(&raw(&header, &[0; 4])).unwrap_err();
    assert_eq!(error, WeightsError::TensorType { name: "output.weight".into(), found: "F16".into() });
}

#[test]
fn parts_that_do_not_fit_together() {
    let change = |edit: &dyn Fn(&mut TensorFile)| {
        let mut file = mlp_file();
        edit(&mut file);
        read(&file.to_bytes().unwrap()).unwrap_err().to_string()
    };
    assert_eq!(
        change(&|f| f.insert("hidden.1.weight", &[5, 3], vec![0.0; 15])),
        "tensor \"hidden.1.weight\" has shape [5, 3], expected [5, 4]"
    );
    assert_eq!(
        change(&|f| f.insert("hidden.1.weight", &[20], vec![0.0; 20])),
        "tensor \"hidden.1.weight\" has shape [20], expected [outputs, inputs]"
    );
    assert_eq!(
        change(&|f| f.insert("hidden.3.weight", &[1, 1], vec![0.0])),
        "tensor \"hidden.3.weight\" belongs to no part of the network"
    );
    assert_eq!(
        read(&TensorFile::new().to_bytes().unwrap()).unwrap_err().to_string(),
        "tensor \"advantage.weight\" is missing"
    );
    let mut intent = TensorFile::new();
    lstm().save(&mut intent, "");
    assert!(Mlp::load(&intent, "").is_err() && Lstm::load(&mlp_file(), "").is_err());
}

/// Widths that multiply to gigabytes, in a file of a few kilobytes.
#[test]
fn widths_that_the_file_does_not_hold_are_not_allocated() {
    let mut file = TensorFile::new();
    for i in 0..8 {
        file.insert(format!("hidden.{i}.weight"), &[4096, 1], vec![0.0; 4096]);
    }
    file.insert("output.weight", &[4096, 1], vec![0.0; 4096]);
    assert!(matches!(
        Mlp::load(&file, ""),
        Err(WeightsError::TensorShape { .. } | WeightsError::MissingTensor { .. })
    ));
    let mut empty = TensorFile::new();
    empty.insert("output.weight", &[0, 3], vec![]);
    let error = WeightsError::Shape(ShapeError::Width { what: "head", found: 0, most: 4096 });
    assert_eq!(Mlp::load(&empty, ""), Err(error));
}

proptest! {
    /// Whatever is done to the bytes of a good file: an error or a network of finite weights, never a panic.
    #[test]
    fn mutilated_files(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        in_header in any::<bool>(),
        cut in prop::option::of(any::<prop::sample::Index>()),
        tail in prop::collection::vec(any::<u8>(), 0..9),
    ) {
        let mut bytes = mlp_file().to_bytes().unwrap();
        let header = 8 + u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
        for (at, byte) in flips {
            let range = if in_header { header } else { bytes.len() };
            bytes[at.index(range)] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        bytes.extend(tail);
        if let Ok(net) = read(&bytes) {
            prop_assert!(net.params().iter().all(|w| w.is_finite()));
        }
    }

    /// Any JSON-like header that claims to be ours.
    #[test]
    fn invented_headers(
        shape in prop::collection::vec(prop_oneof![0usize..6, any::<usize>()], 0..4),
        first in 0usize..9,
        length in prop_oneof![0usize..40, any::<usize>()],
        name in "[a-z_.0-9]{0,20}",
        data in prop::collection::vec(any::<u8>(), 0..64),
    ) {
        let end = first.saturating_add(length);
        for name in [name.as_str(), "output.weight", "lstm.weight_ih_l0", "__metadata__"] {
            let header = format!(
                "{{\"__metadata__\":{{\"{FORMAT_KEY}\":\"{FORMAT_VERSION}\"}},\
                 \"{name}\":{{\"dtype\":\"F32\",\"shape\":{shape:?},\"data_offsets\":[{first},{end}]}}}}"
            );
            if let Ok(file) = TensorFile::from_bytes(&raw(&header, &data)) {
                let _ = Mlp::load(&file, "");
                let _ = Lstm::load(&file, "");
            }
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(TensorFile::from_bytes(&bytes).is_err());
    }
}

#[cfg(feature = "train")]
mod optimiser {
    use super::*;
    use cohelm_nn::adam::{Adam, AdamOptions};

    fn step(net: &mut Mlp, adam: &mut Adam, step: u32) {
        let mut draw = uniform(step);
        let gradient: Vec<f32> = net.params().iter().map(|_| draw() - 0.5).collect();
        adam.step(net.params_mut(), &gradient, 1e-2);
    }

    #[test]
    fn training_goes_on_to_the_bit() {
        let options = AdamOptions { epsilon: 1.234_567_9e-7, largest_norm: Some(0.3), ..Default::default() };
        let (mut net, mut adam) = (mlp(), Adam::new(mlp().params().len(), options));
        (0..5).for_each(|i| step(&mut net, &mut adam, i));

        let mut file = TensorFile::new();
        net.save(&mut file, "net.");
        adam.save(&mut file, "adam.");
        let file = TensorFile::from_bytes(&file.to_bytes().unwrap()).unwrap();
        let mut net_again = Mlp::load(&file, "net.").unwrap();
        let mut adam_again = Adam::load(&file, "adam.", net.params().len()).unwrap();
        assert_eq!(adam_again, adam);

        (5..10).for_each(|i| step(&mut net, &mut adam, i));
        (5..10).for_each(|i| step(&mut net_again, &mut adam_again, i));
        assert_eq!((net_again, adam_again), (net, adam));
    }

    #[test]
    fn constants_that_no_optimiser_has() {
        let mut file = TensorFile::new();
        Adam::new(2, AdamOptions::default()).save(&mut file, "");
        for (key, text) in
            [("beta1", "1.5"), ("beta2", "NaN"), ("epsilon", "0"), ("steps", "-1"), ("largest_norm", "")]
        {
            let mut bad = file.clone();
            bad.set(key, text);
            let error = Adam::load(&bad, "", 2).unwrap_err();
            assert!(matches!(&error, WeightsError::Metadata { key: k, .. } if k == key), "{error}");
        }
        assert!(matches!(Adam::load(&file, "", 3), Err(WeightsError::TensorShape { .. })));
        assert!(matches!(Adam::load(&file, "other.", 2), Err(WeightsError::MissingMetadata { .. })));
    }
}
