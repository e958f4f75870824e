//! PLY: a header that declares elements, then their values in ASCII or binary.
//!
//! `ply-rs-bw` knows how values are written. It believes the header, though: an element of no
//! properties with a count of 2^64 would keep it busy for ever. So the header's claims are held
//! against the bytes that are there before any element is read; and values that programs write but
//! the parser does not know are rewritten for it.

mod ascii;
mod binary;
mod elements;
mod header;
mod line_ends;

use super::ReadError;
use super::log::Log;
use super::polygon::triangulate;
use crate::scene::Mesh;
use elements::{Elements, NO_VERTEX, PlyFace};
use glam::DVec3;
use header::PlyRole;
use ply_rs_bw::ply::Encoding;

/// Reads a mesh; polygons and strips become triangles.
pub(super) fn read(bytes: &[u8], log: &mut Log) -> Result<Mesh, ReadError> {
    if bytes.is_empty() {
        return Err(log.error(None, "the file is empty"));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (mut header, payload) = header::read(bytes, log)?;
    header::check(&mut header, payload.len(), log)?;
    let elements = match header.encoding {
        Encoding::Ascii => ascii::read(payload, &header, log)?,
        _ => binary::read(payload, &header, log)?,
    };
    header::mention_unused(&header, log);
    let has_normals = header
        .elements
        .iter()
        .filter(|e| e.role == PlyRole::PlyVertex)
        .any(|e| e.properties.iter().any(|p| p.used == Some(header::NORMAL[0])));
    mesh(&elements, has_normals, log)
}

fn mesh(elements: &Elements, has_normals: bool, log: &mut Log) -> Result<Mesh, ReadError> {
    let Elements { vertices, faces, strips } = elements;
    let mut mesh = Mesh {
        positions: vertices.iter().map(|v| DVec3::from_array(v.position)).collect(),
        ..Mesh::default()
    };
    if has_normals {
        mesh.normals = vertices.iter().map(|v| DVec3::from_array(v.normal)).collect();
    }
    let mut too_small = 0;
    // Faces whose outline crosses itself: the number of the first, and how many.
    let mut crossing: Option<(usize, usize)> = None;
    let mut corners = Vec::new();
    for (number, face) in faces.iter().enumerate() {
        match face.corners.as_slice() {
            &[a, b, c] => mesh.triangles.push([a, b, c]),
            [] | [_] | [_, _] => too_small += 1,
            indices => {
                corners.clear();
                // An index that names no vertex is found once the mesh is placed.
                let of = |&i: &u32| mesh.positions.get(i as usize).copied().unwrap_or(DVec3::NAN);
                corners.extend(indices.iter().map(of));
                let cut = triangulate(&corners);
                mesh.triangles.extend(cut.indices.iter().map(|t| t.map(|i| indices[i as usize])));
                if cut.self_crossing {
                    crossing.get_or_insert((number + 1, 0)).1 += 1;
                }
            }
        }
    }
    let too_short = unrolled(strips, vertices.len(), &mut mesh.triangles);
    if too_short > 0 {
        log.warn(None, format!("{too_short} strips of fewer than three corners are left out"));
    }
    if too_small > 0 {
        log.warn(None, format!("{too_small} faces of fewer than three corners are left out"));
    }
    if let Some((first, count)) = crossing {
        let text = format!(
            "the outline of {count} polygons, of face {first} first, crosses itself: their \
             triangles may overlap or leave gaps"
        );
        log.warn(None, text);
    }
    if mesh.triangles.is_empty() {
        return Err(log.error(None, "the file has no faces, so there is nothing to show"));
    }
    Ok(mesh)
}

/// The triangles of strips. Returns how many strips were too short to have any.
fn unrolled(strips: &[PlyFace], vertices: usize, triangles: &mut Vec<[u32; 3]>) -> usize {
    // -1 ends a strip, and so does what -1 becomes where indices have no sign.
    let ends = |&i: &u32| i == NO_VERTEX || (i == 0xff || i == 0xffff) && i as usize >= vertices;
    let mut too_short = 0;
    for strip in strips.iter().flat_map(|list| list.corners.split(ends)) {
        if matches!(strip.len(), 1 | 2) {
            too_short += 1;
        }
        for (i, corners) in strip.windows(3).enumerate() {
            let &[a, b, c] = corners else { continue };
            // A corner that is there twice leads to another part of the strip.
            if a != b && b != c && c != a {
                triangles.push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    too_short
}
