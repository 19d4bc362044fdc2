//! How drawn and observed silhouettes are compared.

/// What speaks against a hand that is drawn where none was seen, or not drawn where it was seen, beside how far
/// observed boundaries are from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawnTerm {
    /// Drawn outlines, each place by how far the nearest observed boundary is. What is far away does not pull, so that
    /// fits begin well from poor starts, but outlines come and go as parts of the hand come before others: the
    /// energy jumps by what no slope foretells, and steps near its minimum fail.
    Outline,
    /// The area between the silhouettes, each pixel by how far it is from the observed boundary: the energy has no jumps,
    /// and its slope is what the area wins as drawn outlines move along their normals (Zolésio's shape
    /// derivative; Delfour and Zolésio 2011, § 9.4). For fits that begin near.
    Area,
}
