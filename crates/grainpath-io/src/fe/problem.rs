//! What can be wrong at a place of a finite-element file.

/// What is wrong at the place that [`FeError::Invalid`](super::FeError::Invalid) names.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)]
pub enum FeProblem {
    // Words and numbers in files of any format.
    #[error("found {found:?} where {wanted} should be")]
    NotA { found: String, wanted: &'static str },
    #[error("found {found} where {wanted} should be")]
    Unexpected { found: f64, wanted: &'static str },
    #[error("{0} are far larger than the file; refused as a bomb")]
    Bomb(&'static str),
    #[error("is there twice")]
    Twice,
    // Tables.
    #[error("a header such as x,y,z,sxx,syy,szz,sxy,syz,szx should be here")]
    NoHeader,
    #[error("the header should name columns x and y; nothing else says what the columns are")]
    NoXAndY,
    #[error("found {found:?} where a number should be, column {column}")]
    NotANumberInColumn { found: String, column: usize },
    #[error("{found} columns where the header has {wanted}")]
    Columns { found: usize, wanted: usize },
    // FRD.
    #[error("the file ends in the middle of a block")]
    BlockEnds,
    #[error("element type {0}; types are 1 to 12")]
    ElementType(i64),
    // Gmsh and Medit.
    #[error("no $MeshFormat before it")]
    NoMeshFormat,
    #[error("numbers should be of 8 bytes")]
    NumberSize,
    #[error("the number 1 in binary is missing")]
    NoBinaryOne,
    #[error("the file ends where {0} should be")]
    EndsBefore(&'static str),
    #[error("is there twice, at different places")]
    TwiceElsewhere,
    #[error("the file ends within the header of a result")]
    HeadEnds,
    #[error("{components} components for {n} tuples; 1 to 9 should be")]
    Components { components: usize, n: u64 },
    #[error("dimension {0} should be 2 or 3")]
    Dimension(u64),
    // INP.
    #[error("element {element} has {found} nodes; {kind} has {wanted}")]
    ElementNodes { element: i64, found: usize, kind: String, wanted: usize },
    #[error("element {0} is there twice")]
    ElementTwice(i64),
    #[error("*{0} needs {0}=NAME")]
    NeedsName(&'static str),
    #[error("no set {0:?} before here")]
    NoSetBefore(String),
    #[error("found {found:?} where a face of a {element} should be")]
    NotAFace { found: String, element: &'static str },
    #[error("no node {0}")]
    NoNode(i64),
    #[error("no {what} {name:?}")]
    NoneNamed { what: &'static str, name: String },
    #[error("*{0} before any *STEP")]
    BeforeStep(String),
    #[error("the file has no such step")]
    NoStep,
    #[error("has no section")]
    NoSection,
    // The loads and supports of a deck.
    #[error(
        "changes loads or supports and is not read; put forces, pressures and supports on nodes and faces of the part itself (*CLOAD, *DLOAD, *DSLOAD, *BOUNDARY)"
    )]
    ChangesLoads,
    #[error(
        "is given and is not read; take the amplitude from the load, or state it as a table of factors (*AMPLITUDE)"
    )]
    Amplitude,
    #[error(
        "changes the stress under the loads and is not read; take it out of the deck, or import the solved stress (guide.import)"
    )]
    InitialStress,
    #[error("has no solid elements (C3D4, C3D10, C3D8, ...)")]
    NoSolids,
    #[error(
        "has no isotropic material (*ELASTIC) that all its solid elements share, which guide.deck_material asks for"
    )]
    NoOneMaterial,
    #[error("has neither supports nor loads in a static step")]
    NothingActs,
    #[error("*{0} is not static; only static steps load a part")]
    NotStatic(String),
    #[error("has {found} static steps, more than {most}; choose one with guide.deck_step")]
    TooManySteps { found: usize, most: usize },
    #[error("holds the part in another way than step {first} does; choose one of them with guide.deck_step")]
    OtherSupports { first: usize },
    #[error(
        "prescribe more than {most} different displacements along an axis; supports that rotate are not read"
    )]
    ManyDisplacements { most: usize },
    #[error("carries a load or a support, and is in no solid element")]
    NoSolidHasIt,
    #[error("carries a moment, and nodes of solids do not turn; use forces on several nodes")]
    NodesDoNotTurn,
    #[error("carries a force inside the part; forces are taken on its surface alone")]
    LoadInside,
    #[error("carries a pressure, and is no face of a solid element")]
    PressureNotOnSolid,
    #[error("carries a pressure inside the part; pressures are taken on its surface alone")]
    PressureInside,
    #[error("a centrifugal load needs the square of a speed and the direction of its axis")]
    NoAxis,
    #[error("acts alike on {found} of {all} solid elements; it is taken where it acts alike on all of them")]
    OnPartOfIt { found: usize, all: usize },
    // VTK and VTU.
    #[error("its nodes {from} to {to} are not in the connectivity")]
    NotConnected { from: usize, to: f64 },
    #[error("{cells} cells, but {types} types")]
    CellsAndTypes { cells: usize, types: usize },
    #[error("{0} numbers should follow, the file ends before")]
    NumbersMissing(usize),
    #[error("the list of cells ends before it")]
    ListEnds,
    #[error("no <Piece> in it")]
    NoPiece,
    #[error("no `_` before the data")]
    NoUnderscore,
    /// The XML reader's own words.
    #[error("{0}")]
    Xml(String),
    #[error("a document type definition, which VTU has not")]
    DocumentType,
    #[error("{name} = {text:?} should be a count")]
    NotACount { name: String, text: String },
    #[error("appended, but without an offset")]
    NoOffset,
    #[error("appended, but the file has no AppendedData")]
    NoAppendedData,
    #[error("begins at {0}, behind the end of the file")]
    BeginsBehind(usize),
    #[error("format {0:?} is not ascii, binary or appended")]
    UnknownFormat(String),
    #[error("the data end in the middle")]
    DataEnd,
    #[error("no data")]
    NoData,
    #[error("a block of {packed} bytes cannot hold {size}")]
    PackedTooShort { packed: usize, size: usize },
    #[error("the {compression} block is damaged: {reason}")]
    PackedDamaged { compression: String, reason: String },
    #[error("a {compression} block of {found} bytes where {size} should be")]
    PackedLength { compression: String, found: usize, size: usize },
    #[error("has no Points")]
    NoPoints,
    #[error("{found} numbers where {wanted} should be")]
    Numbers { found: usize, wanted: usize },
    #[error("{offsets} offsets and {types} types for {cells} cells")]
    OffsetsAndTypes { offsets: usize, types: usize, cells: u64 },
    #[error("its pieces have too many different arrays")]
    TooManyArrays,
    #[error("type {0:?} is not one of VTK's")]
    UnknownType(String),
    #[error("NumberOfComponents = {0:?} should be from 1 to 10000")]
    NumberOfComponents(String),
    // Results.
    #[error("no element has finite values at all its nodes")]
    NoFiniteElement,
    #[error("no point has finite values")]
    NoFinitePoint,
    #[error("there are steps 1 to {last}")]
    NoSuchStep { last: usize },
}

impl FeProblem {
    /// Something else stands where `wanted` should.
    pub(super) fn not_a(found: impl Into<String>, wanted: &'static str) -> Self {
        Self::NotA { found: found.into(), wanted }
    }

    /// Nothing of a kind has this name.
    pub(super) fn no(what: &'static str, name: impl Into<String>) -> Self {
        Self::NoneNamed { what, name: name.into() }
    }
}
