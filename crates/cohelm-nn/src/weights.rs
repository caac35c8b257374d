//! Weights and optimiser state as safetensors, with text beside them.
//!
//! A [`TensorFile`] is the content of one file: named f32 tensors and a map of strings. Networks and
//! optimisers put themselves into it and take themselves out, under a prefix, so that a checkpoint holds
//! several of them and a model just one. Reading trusts nothing: see [`WeightsError`]. Files are not touched
//! here; [`TensorFile::to_bytes`] is what a caller writes (atomically) and hashes, the same content always
//! giving the same bytes.
//!
//! Weight matrices are stored as PyTorch stores them, `[outputs][inputs]`, under the names that
//! `docs/networks.md` lists.

mod saved;

use std::collections::BTreeMap;

use safetensors::{Dtype, SafeTensors};

use crate::shape::ShapeError;

/// Largest file read or written, in bytes: far above any network of this crate.
pub const MAX_FILE_BYTES: usize = 256 << 20;
/// Largest header (names, shapes and metadata), in bytes.
pub const MAX_HEADER_BYTES: usize = 1 << 20;
/// Metadata key that marks a file as ours; its value is [`FORMAT_VERSION`].
pub const FORMAT_KEY: &str = "cohelm.weights";
/// Version of tensor names and layout.
pub const FORMAT_VERSION: &str = "1";

/// Why bytes are not the weights that were asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WeightsError {
    /// Too short, cut off, or no safetensors at all.
    #[error("not a safetensors file: {0}")]
    Format(String),
    /// More bytes than any network of this crate has.
    #[error("the file has {found} bytes; weights have at most {MAX_FILE_BYTES}")]
    FileSize {
        /// Length of the file.
        found: usize,
    },
    /// A header length that no weights of this crate have.
    #[error("the header claims {found} bytes; at most {MAX_HEADER_BYTES} are allowed")]
    HeaderSize {
        /// Length that the file claims.
        found: u64,
    },
    /// Safetensors, but written by something else.
    #[error("safetensors, but not cohelm's weights: metadata {FORMAT_KEY:?} is missing")]
    Foreign,
    /// Written by another version of cohelm.
    #[error("weights of format {found:?}; this build reads {FORMAT_VERSION:?}: train or export them again")]
    Version {
        /// The version found.
        found: String,
    },
    /// A tensor that should be there is not.
    #[error("tensor {name:?} is missing")]
    MissingTensor {
        /// Its name.
        name: String,
    },
    /// A tensor that belongs to nothing.
    #[error("tensor {name:?} belongs to no part of the network")]
    UnexpectedTensor {
        /// Its name.
        name: String,
    },
    /// A tensor of the wrong shape.
    #[error("tensor {name:?} has shape {found:?}, expected {expected}")]
    TensorShape {
        /// Its name.
        name: String,
        /// The shape in words or numbers.
        expected: String,
        /// The shape found.
        found: Vec<usize>,
    },
    /// A tensor that is not f32.
    #[error("tensor {name:?} holds {found}, expected F32")]
    TensorType {
        /// Its name.
        name: String,
        /// The type found.
        found: String,
    },
    /// A weight that is NaN or infinite.
    #[error("tensor {name:?} holds {value} at {index}; weights must be finite")]
    NotFinite {
        /// Its name.
        name: String,
        /// Index within the tensor.
        index: usize,
        /// The number there.
        value: f32,
    },
    /// Widths that no network can have.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Metadata that should be there is not.
    #[error("metadata {key:?} is missing")]
    MissingMetadata {
        /// The key.
        key: String,
    },
    /// Metadata that cannot be understood.
    #[error("metadata {key:?} is {found:?}, expected {expected}")]
    Metadata {
        /// The key.
        key: String,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
}

#[derive(Debug, Clone, PartialEq)]
struct Tensor {
    shape: Vec<usize>,
    data: Vec<f32>,
}

/// The content of one file of weights.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TensorFile {
    metadata: BTreeMap<String, String>,
    tensors: BTreeMap<String, Tensor>,
}

impl TensorFile {
    /// An empty one.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets a metadata text, replacing what the key had.
    pub fn set(&mut self, key: impl Into<String>, text: impl Into<String>) {
        self.metadata.insert(key.into(), text.into());
    }

    /// The metadata text of a key.
    ///
    /// # Errors
    /// [`WeightsError::MissingMetadata`].
    pub fn get(&self, key: &str) -> Result<&str, WeightsError> {
        let text = self.metadata.get(key).map(String::as_str);
        text.ok_or_else(|| WeightsError::MissingMetadata { key: key.to_owned() })
    }

    /// All metadata but the format's own mark.
    #[must_use]
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.metadata
    }

    /// Names of all tensors, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.tensors.keys().map(String::as_str)
    }

    /// Puts a tensor in, row-major, replacing what had its name.
    ///
    /// # Panics
    /// If the data is not as long as the shape says.
    pub fn insert(&mut self, name: impl Into<String>, shape: &[usize], data: Vec<f32>) {
        assert_eq!(shape.iter().product::<usize>(), data.len(), "a tensor of shape {shape:?}");
        self.tensors.insert(name.into(), Tensor { shape: shape.to_vec(), data });
    }

    /// The data of a tensor that must have this shape.
    ///
    /// # Errors
    /// [`WeightsError::MissingTensor`] or [`WeightsError::TensorShape`].
    pub fn tensor(&self, name: &str, shape: &[usize]) -> Result<&[f32], WeightsError> {
        let tensor = self.find(name)?;
        if tensor.shape != shape {
            return Err(self.wrong_shape(name, format!("{shape:?}")));
        }
        Ok(&tensor.data)
    }

    fn find(&self, name: &str) -> Result<&Tensor, WeightsError> {
        self.tensors.get(name).ok_or_else(|| WeightsError::MissingTensor { name: name.to_owned() })
    }

    fn wrong_shape(&self, name: &str, expected: String) -> WeightsError {
        let found = self.tensors.get(name).map(|t| t.shape.clone()).unwrap_or_default();
        WeightsError::TensorShape { name: name.to_owned(), expected, found }
    }

    /// The file's bytes; the same content gives the same bytes.
    ///
    /// # Errors
    /// A number that is not finite (a diverged training is not to be saved), or more metadata or weights than
    /// [`TensorFile::from_bytes`] would read.
    pub fn to_bytes(&self) -> Result<Vec<u8>, WeightsError> {
        for (name, tensor) in &self.tensors {
            check_finite(name, &tensor.data)?;
        }
        let header = self.header();
        if header.len() > MAX_HEADER_BYTES {
            return Err(WeightsError::HeaderSize { found: header.len() as u64 });
        }
        let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
        bytes.extend_from_slice(header.as_bytes());
        for tensor in self.tensors.values() {
            bytes.extend(tensor.data.iter().flat_map(|x| x.to_le_bytes()));
        }
        check_size(&bytes)?;
        Ok(bytes)
    }

    /// The JSON header, keys sorted. The safetensors crate writes metadata in the order of a hash map, which
    /// would give one model many hashes; hence this is written here and read by that crate.
    fn header(&self) -> String {
        let mut metadata = self.metadata.clone();
        metadata.insert(FORMAT_KEY.to_owned(), FORMAT_VERSION.to_owned());
        let texts: Vec<String> = metadata.iter().map(|(k, v)| format!("{}:{}", json(k), json(v))).collect();
        let mut entries = vec![format!("\"__metadata__\":{{{}}}", texts.join(","))];
        let mut offset = 0;
        for (name, tensor) in &self.tensors {
            let end = offset + 4 * tensor.data.len();
            let shape: Vec<String> = tensor.shape.iter().map(usize::to_string).collect();
            entries.push(format!(
                "{}:{{\"dtype\":\"F32\",\"shape\":[{}],\"data_offsets\":[{offset},{end}]}}",
                json(name),
                shape.join(",")
            ));
            offset = end;
        }
        let mut header = format!("{{{}}}", entries.join(","));
        // Spaces make the data begin at a multiple of eight bytes, as the format asks.
        while header.len() % 8 != 0 {
            header.push(' ');
        }
        header
    }

    /// Reads a file's bytes.
    ///
    /// # Errors
    /// Whatever is wrong with them, as [`WeightsError`] says; nothing in them can make this panic or allocate
    /// more than a small multiple of their length.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, WeightsError> {
        check_size(bytes)?;
        check_header_size(bytes)?;
        let (_, header) =
            SafeTensors::read_metadata(bytes).map_err(|e| WeightsError::Format(e.to_string()))?;
        let mut metadata: BTreeMap<String, String> =
            header.metadata().iter().flatten().map(|(k, v)| (k.clone(), v.clone())).collect();
        match metadata.remove(FORMAT_KEY) {
            Some(version) if version == FORMAT_VERSION => {}
            Some(found) => return Err(WeightsError::Version { found }),
            None => return Err(WeightsError::Foreign),
        }
        let parsed = SafeTensors::deserialize(bytes).map_err(|e| WeightsError::Format(e.to_string()))?;
        let mut tensors = BTreeMap::new();
        for (name, view) in parsed.tensors() {
            if view.dtype() != Dtype::F32 {
                return Err(WeightsError::TensorType { found: format!("{:?}", view.dtype()), name });
            }
            let data = numbers(view.data());
            check_finite(&name, &data)?;
            tensors.insert(name, Tensor { shape: view.shape().to_vec(), data });
        }
        Ok(Self { metadata, tensors })
    }
}

fn json(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn numbers(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn check_size(bytes: &[u8]) -> Result<(), WeightsError> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(WeightsError::FileSize { found: bytes.len() });
    }
    Ok(())
}

/// The claimed header length comes before any parsing, so that no claim makes the parser work on it.
fn check_header_size(bytes: &[u8]) -> Result<(), WeightsError> {
    let Some(claim) = bytes.first_chunk::<8>() else {
        return Err(WeightsError::Format(format!("{} bytes are too few for a header", bytes.len())));
    };
    let found = u64::from_le_bytes(*claim);
    if found > MAX_HEADER_BYTES as u64 {
        return Err(WeightsError::HeaderSize { found });
    }
    Ok(())
}

fn check_finite(name: &str, data: &[f32]) -> Result<(), WeightsError> {
    match data.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(index) => Err(WeightsError::NotFinite { name: name.to_owned(), index, value: data[index] }),
    }
}
