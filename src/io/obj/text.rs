//! The statements of an OBJ file.

use std::collections::HashMap;

/// What a corner has none of.
pub(super) const NONE: u32 = u32::MAX;

/// Numbers of a position, of texture coordinates and of a normal, from 0.
pub(super) type Corner = [u32; 3];

#[derive(Debug, Default)]
pub(super) struct Obj {
    pub positions: Vec<[f32; 3]>,
    /// As many as positions, or fewer if some have none.
    pub colors: Vec<[f32; 3]>,
    pub texcoords: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    pub objects: Vec<Object>,
    /// What follows each `mtllib`.
    pub libraries: Vec<String>,
}

/// Faces under one name.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// That of the object, or else of the group.
    pub name: Option<String>,
    pub parts: Vec<Part>,
}

/// Faces of one material, which have the same.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub material: Option<String>,
    pub has_texcoords: bool,
    pub has_normals: bool,
    pub corners: Vec<Corner>,
    /// How many corners each face has.
    pub faces: Vec<u32>,
}

/// Where faces go.
#[derive(Default)]
struct State {
    object: Option<String>,
    group: Option<String>,
    material: Option<String>,
    objects: HashMap<Option<String>, usize>,
    parts: HashMap<(usize, Option<String>, bool, bool), usize>,
    /// The greatest number of each kind, counted from 1, and the line of its face.
    greatest: [(u32, usize); 3],
}

impl Obj {
    /// Reads the text; what is wrong, with the number of the line.
    pub fn of(text: &str) -> Result<Self, String> {
        let mut this = Self::default();
        let mut state = State::default();
        let mut lines = text.lines().enumerate();
        while let Some((number, line)) = lines.next() {
            let mut line = std::borrow::Cow::Borrowed(line);
            while let Some(begun) = line.trim_end().strip_suffix('\\') {
                let Some((_, more)) = lines.next() else { break };
                line = format!("{begun} {more}").into();
            }
            this.read(&line, number + 1, &mut state).map_err(|reason| format!("line {}: {reason}", number + 1))?;
        }
        let counts = [this.positions.len(), this.texcoords.len(), this.normals.len()];
        for ((&(greatest, line), count), what) in state.greatest.iter().zip(counts).zip(KINDS) {
            if greatest as usize > count {
                return Err(format!("line {line}: a face refers to {what} {greatest} of {count}"));
            }
        }
        Ok(this)
    }

    fn read(&mut self, line: &str, number: usize, state: &mut State) -> Result<(), String> {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let name = || Some(rest.trim().to_owned()).filter(|name| !name.is_empty());
        match keyword {
            "v" => {
                let values = floats(rest, 3)?;
                self.positions.push([values[0], values[1], values[2]]);
                // Colours, of which the format says nothing, stand behind.
                if let Some(color) = values.get(3..6) {
                    self.colors.push([color[0], color[1], color[2]]);
                }
            }
            "vt" => self.texcoords.push(floats(rest, 2).map(|values| [values[0], values[1]])?),
            "vn" => self.normals.push(floats(rest, 3).map(|values| [values[0], values[1], values[2]])?),
            "f" => self.add_face(rest, number, state)?,
            "o" => (state.object, state.group) = (name(), None),
            "g" => state.group = name(),
            "usemtl" => state.material = name(),
            "mtllib" => self.libraries.extend(name()),
            _ => {}
        }
        Ok(())
    }

    fn add_face(&mut self, rest: &str, number: usize, state: &mut State) -> Result<(), String> {
        let counts = [self.positions.len(), self.texcoords.len(), self.normals.len()];
        let corners = rest.split_whitespace().map(|text| corner(text, counts)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            return Ok(());
        }
        for (kind, greatest) in state.greatest.iter_mut().enumerate() {
            for index in corners.iter().map(|corner| corner[kind]).filter(|index| *index != NONE) {
                if index >= greatest.0 {
                    *greatest = (index + 1, number);
                }
            }
        }
        let [has_texcoords, has_normals] = [1, 2].map(|kind| corners.iter().all(|corner| corner[kind] != NONE));
        let name = state.object.clone().or_else(|| state.group.clone());
        let object = *state.objects.entry(name).or_insert_with_key(|name| {
            self.objects.push(Object { name: name.clone(), parts: Vec::new() });
            self.objects.len() - 1
        });
        let parts = &mut self.objects[object].parts;
        let key = (object, state.material.clone(), has_texcoords, has_normals);
        let part = *state.parts.entry(key).or_insert_with_key(|(_, material, ..)| {
            parts.push(Part { material: material.clone(), has_texcoords, has_normals, ..Part::default() });
            parts.len() - 1
        });
        parts[part].faces.push(corners.len() as u32);
        parts[part].corners.extend(corners);
        Ok(())
    }
}

const KINDS: [&str; 3] = ["position", "texture coordinate", "normal"];

/// At least `count` numbers.
fn floats(text: &str, count: usize) -> Result<Vec<f32>, String> {
    let finite = |word: &str| word.parse().ok().filter(|number: &f32| number.is_finite());
    let number = |word: &str| finite(word).ok_or_else(|| format!("{word:?} is no finite number"));
    let values = text.split_whitespace().map(number).collect::<Result<Vec<f32>, _>>()?;
    if values.len() < count {
        return Err(format!("it has {} of {count} numbers", values.len()));
    }
    Ok(values)
}

/// `1`, `1/2`, `1/2/3` or `1//3`; negative numbers count from the last so far.
fn corner(text: &str, counts: [usize; 3]) -> Result<Corner, String> {
    let mut corner = [NONE; 3];
    let mut words = text.split('/');
    for ((index, word), (count, kind)) in corner.iter_mut().zip(&mut words).zip(counts.into_iter().zip(KINDS)) {
        if word.is_empty() {
            continue;
        }
        let number: i64 = word.parse().map_err(|_| format!("{text:?} is no corner of a face"))?;
        let from_zero = if number < 0 { count as i64 + number } else { number - 1 };
        *index = u32::try_from(from_zero)
            .ok()
            .filter(|index| *index < NONE - 1)
            .ok_or_else(|| format!("a face refers to {kind} {number}, and {count} stand before it"))?;
    }
    if corner[0] == NONE || words.next().is_some() {
        return Err(format!("{text:?} is no corner of a face"));
    }
    Ok(corner)
}
