within Effects;
package Shapes "What a gap may follow that no effect explains: shapes compete with the effects, and are told as shapes, not as names"
end Shapes;
