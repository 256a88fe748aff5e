within Hydraulic;
package EntrainedAir "What becomes of the air in the oil of a volume"
end EntrainedAir;
