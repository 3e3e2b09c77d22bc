// Edits of the scene: a click places a shape, its preview is shown, and Apply changes the scene.
'use strict';

let placed = null;    // position of the shape in metres of the scene; null: nothing is placed
let applying = false;

const metres = (id) => Math.max(0.001, Number(element(id).value) || 0);

function hexColour(text) {
  return [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
}

// Returns the list with the placed edit, in the form of docs/editing.md.
function placedEdits() {
  const [x, y, z] = placed, radius = metres('edit-size'), height = metres('edit-height');
  const shapes = {
    sphere: {sphere: {position_m: [x, y, z], radius_m: radius}},
    box: {box: {min_m: [x - radius, y - radius, z - height / 2], max_m: [x + radius, y + radius, z + height / 2]}},
    cylinder: {cylinder: {position_m: [x, y, z - height / 2], radius_m: radius, height_m: height}},
  };
  const type = element('edit-type').value;
  const edit = {type, ...shapes[element('edit-shape').value]};
  if (type !== 'carve') edit.rgb = hexColour(element('edit-colour').value);
  return {edits: [edit]};
}

async function showPreview() {
  element('edit-apply').disabled = !placed || applying;
  try {
    await ask(forViewer('preview'), placed ? placedEdits() : {edits: []});
    note('');
  } catch (failure) {
    note(failure.message, 10000);
  }
}

async function place(event) {
  if (!viewer || applying || !element('edit').open) return;
  const box = picture.getBoundingClientRect();
  const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height].map(inPicture);
  const {point} = await ask(`${forViewer('point')}&x=${x}&y=${y}`);
  if (!point) return note('Click a surface to place the shape.', 4000);
  placed = point.scene;
  await showPreview();
}

async function change(request, done) {
  if (!viewer || applying) return;
  applying = true;
  element('edit-apply').disabled = true;
  note('The scene is being changed.');
  try {
    await ask(forViewer('edit'), request);
    placed = null;
    note(done, 4000);
  } catch (failure) {
    note(failure.message, 20000);
  }
  applying = false;
  element('edit-apply').disabled = !placed;
}

function cancelEdit() {
  placed = null;
  showPreview();
}

onJoined.push((welcome) => {
  element('edit').hidden = !welcome.may_edit;
  placed = null;
});
onClick.push(place);
for (const id of ['edit-type', 'edit-shape', 'edit-size', 'edit-height', 'edit-colour'])
  element(id).addEventListener('input', () => { if (placed) showPreview(); });
element('edit-apply').addEventListener('click', () => { if (placed) change(placedEdits(), 'Applied.'); });
element('edit-undo').addEventListener('click', () => change({undo: true}, 'The last edit is undone.'));
element('edit-cancel').addEventListener('click', cancelEdit);
element('edit').addEventListener('toggle', () => { if (!element('edit').open && placed) cancelEdit(); });
