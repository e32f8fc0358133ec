"""SDF texts that the tests share."""

from harness.plugins.formats.sdf.world import load_sdf

BOX = "<box><size>0.1 0.2 0.3</size></box>"

SLOTS = {
    "sdf": "",
    "world": "",
    "model": "",
    "include": "",
    "link": "",
    "inertial": "",
    "collision": "",
    "visual": "",
    "geometry": BOX,
    "mesh": "",
    "surface": "",
    "friction": "",
    "friction/ode": "",
    "friction/torsional": "",
    "material": "",
    "joint": "",
    "frame": "",
    "light": "",
    "physics": "",
    "sensor": "",
    "camera": "",
    "image": "",
    "clip": "",
    "noise": "",
}

TEXT = """<?xml version="1.0"?>
<sdf version="1.9">{sdf}
 <world name="w">{world}
  <physics name="p" type="ode">{physics}<max_step_size>0.001</max_step_size></physics>
  <light name="sun" type="directional">{light}<direction>0 0 -1</direction></light>
  <frame name="cell">{frame}<pose>0 0 0.25 0 0 0</pose></frame>
  <model name="m">{model}<pose relative_to="cell">0 0 -0.25 0 0 0</pose>
   <link name="l">{link}
    <inertial>{inertial}<mass>2</mass>
     <inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial>
    <collision name="c">{collision}<geometry>{geometry}</geometry>
     <surface>{surface}<friction>{friction}<ode>{friction/ode}<mu>0.5</mu></ode>
      <torsional>{friction/torsional}</torsional></friction></surface></collision>
    <visual name="v">{visual}<geometry>{geometry}</geometry>
     <material>{material}<diffuse>0 1 0 1</diffuse></material></visual>
    <sensor name="eye" type="camera">{sensor}<camera>{camera}<image>{image}<height>240</height>
     </image><clip>{clip}<far>9</far></clip><noise>{noise}<type>gaussian</type></noise></camera>
    </sensor>
   </link>
   <link name="lid"><pose>0 0 1 0 0 0</pose>
    <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
    <collision name="c"><geometry><mesh>{mesh}<uri>part.obj</uri></mesh></geometry></collision>
   </link>
   <joint name="j" type="fixed">{joint}<parent>l</parent><child>lid</child></joint>
  </model>
  <include>{include}<uri>model://crate</uri></include>
 </world>
</sdf>
"""

CRATE = """<sdf version="1.9"><model name="crate"><pose>1 0 0 0 0 0</pose>
 <link name="base"><inertial><mass>1</mass>
   <inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
  <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
 <frame name="top"><pose>0 0 0.1 0 0 0</pose></frame>
</model></sdf>
"""

TETRAHEDRON = """v 0 0 0
v 0.1 0 0
v 0 0.1 0
v 0 0 0.1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""


ASCII_STL = """solid part
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 0.1 0
vertex 0.1 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 0.1 0 0
vertex 0 0 0.1
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 0.1
vertex 0 0.1 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 0.1 0 0
vertex 0 0.1 0
vertex 0 0 0.1
endloop
endfacet
endsolid part
"""

COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit meter="0.1"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
   <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common>
  </source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
   <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>
  </visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def write(folder, text, name="world.sdf"):
    """A world file with a model and a mesh next to it."""
    (folder / "crate").mkdir(exist_ok=True)
    (folder / "crate" / "model.sdf").write_text(CRATE, encoding="utf-8")
    (folder / "part.obj").write_text(TETRAHEDRON, encoding="utf-8")
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def text_with(kind="", snippet=""):
    """The world with something put first into its element of a kind."""
    slots = SLOTS | ({kind: snippet} if kind else {})
    text = TEXT
    for slot, content in slots.items():
        text = text.replace(f"{{{slot}}}", content)
    return text


def load(folder, text):
    """What a text imports as."""
    imported = load_sdf(write(folder, text))
    imported.refuse_unusable()
    return imported
